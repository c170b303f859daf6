// A pair of bodies that the page makes itself, and how they move.
import type { Body } from './engine';

export const kTimeStep = 1 / 60; // seconds between frames

export interface Moves {
  /// The vertices of both bodies a time step later.
  advance(): [Float64Array, Float64Array] | Promise<[Float64Array, Float64Array]>;
}

export interface Scene extends Moves {
  title: string;
  words: string; ///< what is seen, a sentence
  bodies: [Body, Body];
  units: string;
}
