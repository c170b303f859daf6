// What the calls of the package take. All are checked by one table; those of workers, too, which end in the same methods.
import { Animation } from './animation.js';
import { shown } from './given.js';
import { Look } from './look.js';
import { Matches } from './matches.js';
import { Pair } from './pair.js';
import { Sites } from './sites.js';
import { DistanceMap, Surface } from './surface.js';
import { SdmError } from './types.js';

/** Throws SdmError unless the value is one. `name`: of the argument or option. */
type Check = (value: unknown, name: string, call: string) => void;
type Checks = Record<string, Check>;

interface Call {
  /** By their names, in their order. */
  values: Checks;
  options: Checks;
  /** Whether there are others, which C++ declares and the module checks. */
  declared: boolean;
}

const refuse = (name: string, value: unknown, needed: string) => {
  throw new SdmError('input', `${name} is ${shown(value)}: it must be ${needed}`);
};
const check =
  (holds: (value: unknown) => boolean, needed: string): Check =>
  (value, name) => {
    if (!holds(value)) refuse(name, value, needed);
  };
const isObject = (value: unknown): value is object => typeof value === 'object' && value !== null;
const isBytes = (value: unknown) => value instanceof Uint8Array || value instanceof ArrayBuffer;

/** Checked where it is read. */
export const anything: Check = () => {};
const number = check((value) => typeof value === 'number' && !Number.isNaN(value), 'a number');
const flag = check((value) => typeof value === 'boolean', 'true or false');
const word = check((value) => typeof value === 'string', 'a string');
const twoWords = check(
  (value) => Array.isArray(value) && value.length === 2 && value.every((one) => typeof one === 'string'),
  'two strings',
);
const bytes = check(isBytes, 'a Uint8Array or an ArrayBuffer');
const callback = check((value) => typeof value === 'function', 'a function');
const whole = (least: number, most = 0xffffffff) =>
  check(
    (value) => Number.isInteger(value) && (value as number) >= least && (value as number) <= most,
    most < 0xffffffff ? `an integer from ${least} to ${most}` : `an integer of at least ${least}`,
  );
const files = check(
  (value) => isObject(value) && Object.values(value).every(isBytes),
  'an object with a Uint8Array or an ArrayBuffer for each path',
);

const numbers: Check = (value, name) => {
  const isArray =
    Array.isArray(value) ||
    (ArrayBuffer.isView(value) &&
      !(value instanceof DataView) &&
      typeof (value as unknown as ArrayLike<unknown>)[0] !== 'bigint');
  if (!isArray) refuse(name, value, 'an array of numbers');
  if (!Array.isArray(value)) return;
  for (let i = 0; i < value.length; ++i)
    if (typeof value[i] !== 'number') refuse(`${name}[${i}]`, value[i], 'a number');
};
const body: Check = (value, name, call) => {
  if (!isObject(value)) refuse(name, value, 'an object with positions, and perhaps indices');
  const { positions, indices } = value as { positions?: unknown; indices?: unknown };
  numbers(positions, `positions of the ${name} body`, call);
  optional(numbers)(indices, `indices of the ${name} body`, call);
};
const picture: Check = (value, name) => {
  const { width, height, data } = (isObject(value) ? value : {}) as Record<string, unknown>;
  if (
    !Number.isInteger(width) ||
    !Number.isInteger(height) ||
    !(data instanceof Uint8Array || data instanceof Uint8ClampedArray)
  )
    refuse(name, value, 'an object with width, height, and data in a Uint8Array or Uint8ClampedArray');
};
export const object =
  (Kind: abstract new (...values: never[]) => object, needed: string): Check =>
  (value, _, call) => {
    if (!(value instanceof Kind))
      throw new SdmError('input', `${call} needs ${needed}, but was given ${shown(value)}`);
  };
function optional(one: Check): Check {
  return (value, name, call) => {
    if (value !== undefined && value !== null) one(value, name, call);
  };
}

const list = (words: string[]) =>
  words.length > 1 ? `${words.slice(0, -1).join(', ')} and ${words.at(-1)}` : words[0];

/** Throws SdmError for options that there are not, and for wrong ones. */
function checkOptions(call: string, given: unknown, options: Checks, declared = false): void {
  if (given === undefined) return;
  if (!isObject(given) || Array.isArray(given) || ArrayBuffer.isView(given))
    refuse(`the last argument of ${call}`, given, 'an object of options');
  for (const [name, value] of Object.entries(given as object)) {
    if (value === undefined) continue;
    if (!Object.hasOwn(options, name)) {
      if (declared) continue;
      const known = Object.keys(options).filter((one) => one !== 'progress');
      throw new SdmError(
        'input',
        `${call} has no option ${name}${known.length > 0 ? `; it has ${list(known)}` : ''}`,
      );
    }
    optional(options[name]!)(value, name, call);
  }
}

function checkCall(name: string, { values, options, declared }: Call, given: unknown[]): void {
  const entries = Object.entries(values);
  entries.forEach(([value, one], i) => one(given[i], value, name));
  checkOptions(name, given[entries.length], options, declared);
}

const progress = callback;
export const take = (values: Checks, options: Checks = {}): Call => ({
  values,
  options: { ...options, progress },
  declared: false,
});
/** With options that C++ declares. */
export const takeDeclared = (values: Checks, options: Checks = {}): Call => ({
  ...take(values, options),
  declared: true,
});

export const mesh = { positions: numbers, indices: optional(numbers) };
const file = { bytes, name: word };
export const ofSurface = { uvs: numbers, storedAtlas: bytes };
export const ofMap = { rest: numbers };
const ofFiles = { names: twoWords, xxh3: twoWords };
const aSurface = object(Surface, 'a Surface');
const sites = object(Sites, 'Sites');

const kNew: Record<string, Call> = {
  Surface: takeDeclared(mesh, ofSurface),
  Sites: take(mesh),
  Pair: takeDeclared({ first: body, second: body }),
};
/** Of the library itself. */
export const kLibraryCalls: Record<string, Call> = {
  surface: kNew['Surface']!,
  sites: kNew['Sites']!,
  pair: kNew['Pair']!,
  readMesh: take(file, { files }),
  readLook: take(file, { files }),
  readAnimation: take(file, { files, rate: number }),
  match: takeDeclared({ surface: aSurface, sites }),
  unitCheck: take({ mesh: body, sites }),
};
const kCalls: [Kind: { prototype: object }, calls: Record<string, Call>][] = [
  [
    Sites,
    {
      refit: take({ positions: numbers }),
      closestPoints: takeDeclared({ points: numbers }),
      signedDistance: takeDeclared({ points: numbers }),
      firstHits: takeDeclared({ origins: numbers, directions: numbers }),
      hausdorff: takeDeclared({ other: sites }),
    },
  ],
  [
    Surface,
    { refit: take({ positions: numbers }), map: takeDeclared({ sites }, ofMap), emptyMap: take({ sites }) },
  ],
  [
    DistanceMap,
    {
      compute: takeDeclared({}, ofMap),
      computeSamples: takeDeclared({ first: whole(0), count: whole(0) }, ofMap),
      valuesOfSamples: take({ first: whole(0), count: whole(0) }),
      transfer: takeDeclared({ values: numbers }),
      summary: takeDeclared({}, ofFiles),
      report: takeDeclared({}, ofFiles),
    },
  ],
  [
    Matches,
    {
      transfer: takeDeclared({ values: numbers }),
      bake: take({ look: object(Look, 'a Look') }),
      normals: take({}, { tangentSpace: flag, look: object(Look, 'a Look'), pose: numbers }),
      normalsOf: take({ look: optional(object(Look, 'a Look')) }, { tangentSpace: flag, pose: numbers }),
      model: take({}, { tangents: flag }),
    },
  ],
  [Look, { setPicture: take({ texture: whole(0), picture }) }],
  [Animation, { positions: take({ frame: whole(0) }) }],
  [
    Pair,
    {
      setPose: take({ body: whole(0, 1), matrix: numbers }),
      refit: take({ body: whole(0, 1), positions: numbers }),
    },
  ],
];

/** The words by which users know methods that workers call. */
const kNames: Record<string, string> = { emptyMap: 'map', compute: 'map', normalsOf: 'normals' };

/** Lets methods check what they are given; those that return promises reject. */
export function checkMethods(
  Kind: { prototype: object },
  calls: Record<string, Call>,
  rejecting: readonly string[] = [],
): void {
  const methods = Kind.prototype as Record<string, (...given: unknown[]) => unknown>;
  for (const [name, call] of Object.entries(calls)) {
    const method = methods[name]!;
    methods[name] = function (...given) {
      try {
        checkCall(kNames[name] ?? name, call, given);
      } catch (error) {
        if (rejecting.includes(name)) return Promise.reject(error);
        throw error;
      }
      return method.apply(this, given);
    };
  }
}
for (const [Kind, calls] of kCalls) checkMethods(Kind, calls, ['report']);

/** Checks what start(), createWorker() and createPool() are given. */
export function checkStart(call: string, given: unknown): void {
  const threads = whole(1, 256);
  checkOptions(call, given, {
    threads,
    full: flag,
    modules: check(isObject, 'an object of modules'),
    reportPage: word,
    script: check((value) => typeof value === 'string' || value instanceof URL, 'an address'),
    ...(call === 'createPool' ? { workers: threads } : {}),
  });
}

/** A class whose objects are in a module, and whose constructor checks what it is given. */
export function constructorIn<Made>(
  module: unknown,
  name: string,
  Kind: abstract new (...values: any[]) => object,
): Made {
  const Checked = class extends (Kind as new (...values: any[]) => object) {
    constructor(...given: unknown[]) {
      checkCall(name, kNew[name]!, given);
      super(module, ...given);
    }
  };
  Object.defineProperty(Checked, 'name', { value: name });
  return Checked as Made;
}
