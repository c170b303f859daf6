// The colours of maps: those of reports (src/io/image/pictures/color_scale.cpp); a test compares both.

export type Rgb = readonly [number, number, number];

export const kColormaps = {
  viridis: [
    [68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141], [42, 120, 142], [33, 145, 140], [34, 168, 132], [68, 191, 112],
    [122, 209, 81], [189, 223, 38], [253, 231, 37],
  ],
  diverging: [
    [5, 48, 97], [33, 102, 172], [67, 147, 195], [146, 197, 222], [209, 229, 240], [255, 255, 255], [253, 219, 199], [244, 165, 130],
    [214, 96, 77], [178, 24, 43], [103, 0, 31],
  ],
} as const satisfies Record<string, readonly Rgb[]>;
export const kWithin: readonly Rgb[] = [[225, 243, 233], [176, 224, 199], [122, 196, 161], [66, 158, 122]];
export const kAbove: readonly Rgb[] = [[255, 214, 94], [240, 120, 40], [165, 15, 21]];
export const kBelow: readonly Rgb[] = [[150, 200, 235], [60, 130, 200], [8, 48, 107]];
export const kNoValue: Rgb = [128, 130, 134];
