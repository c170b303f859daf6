// The search on a device: the faces that may be closest to each of many points, by the shaders of the native engine
// (src/gpu/face_search.cpp).
import { type GpuDevice, type Step } from './gpu_device.js';
import { type Module } from './module.js';
import { kWgsl } from './wgsl.js';

// As in shaders/faces.wgsl and src/gpu/face_lists.h.
export const kTile = 64; // points that are searched together
const kPointBytes = 16;
export const kListBytes = 64;
const kTileBytes = 96;

const kKept = 4; // shapes

/** The tree and the faces of sites, as one part or as several that a program can bind. */
export interface SitesOnGpu {
  shape: number;
  errors: GPUBuffer;
  /** Of each part, its first face. */
  firsts: Uint32Array;
  parts: { boxes: GPUBuffer; leaves: GPUBuffer; faces: GPUBuffer }[];
}

interface Room {
  points: GPUBuffer;
  results: GPUBuffer;
  tiles: GPUBuffer;
  readBack: GPUBuffer;
}

export class GpuSearch {
  private readonly kept: SitesOnGpu[] = []; // the last ones that were used, the latest first
  private readonly part: GPUBuffer;
  private room: Room | undefined;
  private roomPoints = 0;

  private constructor(
    readonly device: GpuDevice,
    private readonly programs: {
      balls: GPUComputePipeline;
      together: GPUComputePipeline;
      alone: GPUComputePipeline;
    },
  ) {
    this.part = device.buffer(16, GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST, 'constants');
  }

  /** Throws SdmError if the programs cannot be compiled. */
  static async on(device: GpuDevice): Promise<GpuSearch> {
    const { faces, nearestFirst, part, tileBalls, closestTiles, closestFaces } = kWgsl;
    const [balls, together, alone] = await Promise.all([
      device.pipeline(faces, nearestFirst, part, tileBalls),
      device.pipeline(faces, closestTiles),
      device.pipeline(faces, nearestFirst, closestFaces),
    ]);
    return new GpuSearch(device, { balls, together, alone });
  }

  /** Sites of a module in their present shape, on the device. */
  async place(module: Module, sites: number): Promise<SitesOnGpu> {
    const { number, errors } = module.call<{ number: number; errors: Uint8Array }>('sdm_gpu_shape', [sites]);
    const at = this.kept.findIndex(({ shape }) => shape === number);
    if (at >= 0) this.kept.unshift(...this.kept.splice(at, 1));
    else {
      // Memory of the one that was not used for longest comes first.
      for (const old of this.kept.splice(kKept - 1)) release(old);
      this.kept.unshift(
        await this.device.guarded('copied O2 to it', () => this.upload(module, sites, number, errors)),
      );
    }
    return this.kept[0]!;
  }

  private upload(module: Module, sites: number, shape: number, bounds: Uint8Array): SitesOnGpu {
    const { device } = this;
    const uploaded = (bytes: ArrayBufferView, usage: number, purpose: string) => {
      const buffer = device.buffer(bytes.byteLength, usage | GPUBufferUsage.COPY_DST, purpose);
      device.write(buffer, bytes as GPUAllowSharedBufferSource);
      return buffer;
    };
    const stored = (bytes: ArrayBufferView, purpose: string) =>
      uploaded(bytes, GPUBufferUsage.STORAGE, purpose);
    const parts: SitesOnGpu['parts'] = [];
    const firsts: number[] = [];
    const kNone = 0xffffffff;
    for (let leaf = 0; leaf !== kNone; ) {
      const part = module.call<{
        first: number;
        endLeaf: number;
        boxes: Uint8Array;
        leaves: Uint32Array;
        faces: Uint8Array;
      }>('sdm_gpu_part', [sites, leaf, device.mostBytes]);
      firsts.push(part.first);
      parts.push({
        boxes: stored(part.boxes, 'the tree of O2'),
        leaves: stored(part.leaves, 'the leaves of O2'),
        faces: stored(part.faces, 'the faces of O2'),
      });
      leaf = part.endLeaf;
    }
    const errors = uploaded(bounds, GPUBufferUsage.UNIFORM, 'constants');
    return { shape, errors, firsts: Uint32Array.from(firsts), parts };
  }

  private reserve(count: number): Room {
    if (this.room && count <= this.roomPoints) return this.room;
    Object.values(this.room ?? {}).forEach((buffer: GPUBuffer) => buffer.destroy());
    this.room = undefined;
    const { device } = this;
    const { STORAGE, COPY_DST, COPY_SRC, MAP_READ } = GPUBufferUsage;
    this.room = {
      points: device.buffer(count * kPointBytes, STORAGE | COPY_DST, 'points'),
      results: device.buffer(count * kListBytes, STORAGE | COPY_SRC, 'results'),
      tiles: device.buffer((count / kTile) * kTileBytes, STORAGE, 'tiles'),
      readBack: device.buffer(count * kListBytes, MAP_READ | COPY_DST, 'results'),
    };
    this.roomPoints = count;
    return this.room;
  }

  /** The lists of points, as `points` of sdm_gpu_points(), whose number is a multiple of kTile: for one part after the other. */
  async find(sites: SitesOnGpu, points: Uint8Array): Promise<Uint8Array> {
    const count = points.byteLength / kPointBytes;
    const bytes = count * kListBytes;
    const lists = new Uint8Array(sites.parts.length * bytes);
    for (const [i, part] of sites.parts.entries())
      await this.device.guarded('searched', async () => {
        const { device } = this;
        const room = this.reserve(count);
        device.write(this.part, Uint32Array.of(count / kTile, 0, 0, 0));
        device.write(room.points, points as GPUAllowSharedBufferSource);
        const encoder = device.record(this.steps(sites.errors, part, room, count / kTile));
        encoder.copyBufferToBuffer(room.results, 0, room.readBack, 0, bytes);
        device.device.queue.submit([encoder.finish()]);
        await room.readBack.mapAsync(GPUMapMode.READ, 0, bytes);
        lists.set(new Uint8Array(room.readBack.getMappedRange(0, bytes)), i * bytes);
        room.readBack.unmap();
      });
    return lists;
  }

  /** The steps of the search, which follow each other (docs/design/gpu.md). */
  private steps(errors: GPUBuffer, part: SitesOnGpu['parts'][0], room: Room, tiles: number): Step[] {
    const { balls, together, alone } = this.programs;
    const all = { 0: errors, 1: part.boxes, 2: part.leaves, 3: part.faces, 4: room.points, 6: room.tiles };
    const step = (pipeline: GPUComputePipeline, others: Record<number, GPUBuffer>, workgroups: number) => ({
      pipeline,
      group: this.device.bind(pipeline, { ...all, ...others }),
      workgroups,
    });
    return [
      step(balls, { 7: this.part }, Math.ceil(tiles / 64)),
      step(together, { 5: room.results }, tiles),
      step(alone, { 5: room.results }, tiles),
    ];
  }
}

function release({ errors, parts }: SitesOnGpu): void {
  for (const buffer of [errors, ...parts.flatMap((part) => Object.values(part))]) buffer.destroy();
}
