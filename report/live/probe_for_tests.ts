// What tests ask a live page.
import { Matrix4 } from 'three';
import type { MatchCounts, SdmWorker } from 'sdm';
import type { Report, Vec } from '../src/page_data';
import type { Baking } from './baking';
import { inFile, moved } from './placing';
import type { Motion } from './motion';
import { decoded } from './pictures';
import type { Session } from './session';

export class Probe {
  constructor(
    private readonly session: Session,
    private readonly motion: Motion,
    private readonly baking: Baking,
  ) {}

  get firstPicture(): Promise<void> {
    return this.session.pair!.view.firstPicture;
  }
  get worker(): SdmWorker {
    return this.session.worker;
  }
  get numbers(): Report | null {
    return this.session.report;
  }
  get atRest(): boolean {
    return (
      !this.motion.isPumping &&
      !this.session.moving &&
      !this.session.loading &&
      (this.session.pair?.view.atRest ?? false)
    );
  }
  get counts(): MatchCounts | null {
    return this.baking.counts;
  }
  /// The share of texels with a point whose pixels in `png` differ by more than `most` from what is shown.
  async differing(png: Uint8Array<ArrayBuffer>, most: number): Promise<number> {
    const shown = this.session.pair!.subject.surface.painted!.pixels;
    const { data } = await decoded(png);
    if (data.length !== shown.length)
      throw new Error(`the picture has ${data.length / 4} pixels, and ${shown.length / 4} are shown`);
    let [texels, differ] = [0, 0];
    const { texelFaces } = this.session.pair!.subject.surface.layout;
    for (let i = 0; i < shown.length; i += 4) {
      if (texelFaces[i / 4] === 0xffffffff || shown[i + 3] === 0) continue;
      ++texels;
      if ([0, 1, 2].some((k) => Math.abs(shown[i + k] - data[i + k]) > most)) ++differ;
    }
    return differ / texels;
  }
  handleAt(axis: 'X' | 'Y' | 'Z'): { x: number; y: number } {
    return this.session.pair!.view.handleAt(axis);
  }
  get handle(): string | null {
    return this.session.pair!.view.handle;
  }
  memoryBytes(): Promise<number> {
    return this.session.worker.memoryBytes();
  }

  /// The bodies as they are, with the reference moved.
  get meshes() {
    const [part, reference] = this.session.bodies!;
    const { view, subject } = this.session.pair!;
    return [part, { ...reference, positions: moved(reference.positions, inFile(view.motion, subject)) }].map(
      ({ name, positions, indices }) => ({
        name,
        positions: Array.from(positions),
        indices: Array.from(indices),
      }),
    );
  }

  /// Whether all of the part is in the picture.
  get fits(): boolean {
    const { view, subject } = this.session.pair!;
    const { clientWidth, clientHeight } = view.canvas;
    return Array.from({ length: 8 }, (_, corner) =>
      view.place([0, 1, 2].map((k) => (corner & (1 << k) ? subject.hi : subject.lo)[k]) as Vec),
    ).every(({ x, y }) => x >= 0 && y >= 0 && x <= clientWidth && y <= clientHeight);
  }

  /// The layout of the surface that is drawn.
  get drawn() {
    const { model, map, areas } = this.session.pair!.subject.surface.layout;
    return {
      triangles: model.trianglesOfMesh,
      resolution: map.width,
      area: areas.reduce((a, b) => a + b, 0),
    };
  }

  /// Milliseconds of each of a number of frames of the coarse map, without pictures.
  async measure(frames: number): Promise<number[]> {
    const { session, motion } = this;
    const times: number[] = [];
    for (let i = 0; i < frames; ++i) {
      if (!session.scene)
        motion.want(inFile(new Matrix4().makeRotationZ((2 * Math.PI * i) / frames), session.pair!.subject));
      times.push((await session.inOrder(() => motion.nextFrame(true))).milliseconds);
    }
    motion.rest();
    return times;
  }
}
