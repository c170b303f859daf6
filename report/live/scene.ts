// A pair of bodies that the page makes itself.
import type { Body, Moves } from './body';

export interface Scene extends Moves {
  title: string;
  words: string; ///< what is seen, a sentence
  bodies: [Body, Body];
  units: string;
}
