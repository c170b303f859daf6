// What the reference has at the points that belong to the texels of the map at rest: its colours and normals, as a texture.
import type { MatchCounts, MatchOptions, WorkerMatches } from 'sdm';
import type { BakeChoices, BakeTab } from './bake_tab';
import { download } from '../src/saved';
import { bakedGlb } from './baked_model';
import { inFile } from './placing';
import { Looks } from './looks';
import { kUp } from './pair';
import type { Session } from './session';
import type { Paint } from './subject';

const kTooFar = 4; // of kMatchKinds
const kFacingAway = 5;

/// Four bytes a texel, of a picture of 1, 3 or 4; alpha says whether there is a point.
function pixelsOf(picture: Uint8Array, components: number, kinds: Uint8Array): Uint8Array {
  const pixels = new Uint8Array(4 * kinds.length);
  for (let i = 0; i < kinds.length; ++i) {
    for (let k = 0; k < 3; ++k) pixels[4 * i + k] = picture[components * i + (components < 3 ? 0 : k)];
    pixels[4 * i + 3] = kinds[i] === kTooFar || kinds[i] === kFacingAway ? 0 : 255;
  }
  return pixels;
}

export class Baking implements BakeChoices {
  options: MatchOptions = { method: 'facing', facing: 90 };
  kind: Paint['kind'] | null = null; // that is shown in place of the distances
  counts: MatchCounts | null = null;
  private readonly looks: Looks;
  private version = 0;
  private notes: string[] = []; // on what the file of the reference lacks

  constructor(
    private readonly session: Session,
    private readonly tab: BakeTab,
  ) {
    this.looks = new Looks(session.worker);
  }

  /// A pair is new.
  renew(): void {
    this.looks.forget();
    this.hide();
  }

  /// Something moves: until the next rest, distances are shown.
  hide(): void {
    ++this.version;
    this.counts = null;
    const { pair } = this.session;
    pair?.subject.surface.setPaint(null);
    pair?.subject.coarse.setPaint(null);
    this.tab.showCounts(null, this.kind !== null);
  }

  /// Bakes what is shown, at rest.
  async update(): Promise<void> {
    const { session } = this;
    this.hide();
    if (this.kind === null || session.moving || !session.pair) return session.pair?.view.draw();
    const { version, kind } = this;
    const isOn = () => version === this.version && !session.moving;
    const baked = await session.inOrder(async () => (isOn() ? this.paintOf(kind) : null));
    if (!isOn()) return;
    if (!baked) return this.tab.showMissing(session.bodies![1].name, this.notes);
    this.counts = baked.counts;
    session.pair.subject.surface.setPaint(baked.paint);
    session.pair.view.draw();
    this.tab.showCounts(baked.counts, true, kind === 'colors' ? this.notes : []);
  }

  /// Null: the reference has no colours.
  private async paintOf(kind: Paint['kind']): Promise<{ paint: Paint; counts: MatchCounts } | null> {
    const look = kind === 'colors' ? await this.lookWithColors() : null;
    if (kind === 'colors' && !look) return null;
    const matches = await this.session.engine.match(this.options);
    try {
      const [{ kinds }, counts] = await Promise.all([matches.arrays(), matches.counts()]);
      if (!look)
        return { paint: { kind, pixels: pixelsOf(await this.normalsOf(matches, false), 3, kinds) }, counts };
      const { textures } = await matches.bake(look);
      const { data, components } = textures.find(({ channel }) => channel === 'base_color')!;
      return { paint: { kind, pixels: pixelsOf(data, components, kinds) }, counts };
    } finally {
      matches.dispose();
    }
  }

  private async lookWithColors() {
    const look = await this.looks.lookOf(this.session.bodies![1]);
    this.notes = look ? await look.notes() : [];
    return look && (look.hasColors || look.hasMaterials) ? look : null;
  }

  /// Normals of the file turn with the reference; a body that has deformed has those of its shape.
  private async normalsOf(matches: WorkerMatches, tangentSpace: boolean): Promise<Uint8Array> {
    const { bodies, pair, engine } = this.session;
    const look = engine.deformed ? null : await this.looks.lookOf(bodies![1]);
    return matches.normals({
      look: look ?? undefined,
      pose: inFile(pair!.view.motion, pair!.subject).elements,
      tangentSpace,
    });
  }

  /// All textures on the part, as a GLB.
  glb(): Promise<ArrayBuffer> {
    const { session } = this;
    return session.inOrder(async () => {
      const matches = await session.engine.match(this.options);
      try {
        const look = await this.lookWithColors();
        const [baked, normals, model] = [
          look && (await matches.bake(look)),
          await this.normalsOf(matches, true),
          await matches.model({ tangents: true }),
        ];
        return await bakedGlb(model, baked, normals, matches.resolution, kUp, session.units);
      } finally {
        matches.dispose();
      }
    });
  }
}

export async function saveBaked(baking: Baking): Promise<void> {
  download('baked.glb', 'model/gltf-binary', await baking.glb());
}
