// What the maps of a surface measure.
import type * as declared from './declared.js';
import { coordinates } from './geometry.js';
import { declaredOptions } from './given.js';
import { type Points, type Progress } from './types.js';

interface SitesOptions extends declared.MapOptions, declared.MeasureChoice {
  measure?: 'sites' | undefined;
}

interface SelfOptions extends declared.SelfOptions, declared.MeasureChoice {
  measure: 'self';
  /** The positions of the mesh before it was deformed, which decide what is near along the surface; by default the present ones. */
  rest?: Points | undefined;
}

interface ThicknessOptions extends declared.ThicknessOptions, declared.MeasureChoice {
  measure: 'thickness';
}

/** The options of what is measured. */
export type MapOptions = { progress?: Progress | undefined } & (
  | SitesOptions
  | SelfOptions
  | ThicknessOptions
);

/** Options as the module takes them (GivenMeasure of module/measures.h). */
export type MeasureArguments = [
  options: string,
  numbers: Float64Array,
  rest: Float64Array | null,
  vertices: number,
];

export function measureArguments(given: MapOptions): MeasureArguments {
  const { rest, ...others } = given.measure === 'self' ? given : { ...given, rest: undefined };
  if (!rest) return [...declaredOptions(given), null, 0];
  const at = coordinates(rest, 'rest');
  return [...declaredOptions(others), at, at.length / 3];
}

/** Whether each part of a map costs what the whole does before its first value: of what faces exclude, or of the walls of a solid. */
export const preparesMuch = ({ measure }: { measure?: declared.MapMeasure | undefined }): boolean =>
  measure === 'self' || measure === 'thickness';
