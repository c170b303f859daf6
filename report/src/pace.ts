// How finely to draw while something moves: coarser pictures where fine ones take too long, as they do without a GPU.

const kSlow = 40; // milliseconds of a picture, above which those of a motion are coarse
const kFast = 15; // of a coarse picture, below which it may have more pixels
const kStep = 0.75; // of the pixel ratio
const kLeast = 0.25;
const kRest = 250; // milliseconds without a change, after which the picture is fine again

export class Pace {
  moving = false; ///< pictures are coarse
  ratio = 0.5; ///< of coarse pictures, relative to fine ones
  complete = (): void => {}; ///< called when a picture is complete
  private fine = 0; // milliseconds of the last fine picture
  private pending = false; // a picture is not complete
  private timer = 0;

  /// `rest` is called when nothing has changed for a while after coarse pictures; `slow` when fine pictures are found to
  /// take long, so that coarse ones can be prepared.
  constructor(
    private readonly gl: WebGL2RenderingContext,
    private readonly rest: () => void,
    private readonly slow: () => void,
  ) {}

  /// Something changes: whether pictures of it are coarse.
  change(): boolean {
    if (this.fine <= kSlow) return false;
    this.moving = true;
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => {
      this.moving = false;
      this.rest();
    }, kRest);
    return true;
  }

  /// Whether another picture would only wait for the last one.
  get busy(): boolean {
    return this.pending;
  }

  /// After the commands of a picture: finds out how long they take.
  drawn(): void {
    const { gl } = this;
    const { moving } = this;
    const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    if (!sync) {
      this.complete();
      return;
    }
    const begin = performance.now();
    this.pending = true;
    const look = () => {
      const state = gl.clientWaitSync(sync, 0, 0);
      if (state === gl.TIMEOUT_EXPIRED) {
        window.setTimeout(look, 4);
        return;
      }
      gl.deleteSync(sync);
      this.pending = false;
      this.complete();
      this.took(performance.now() - begin, moving);
    };
    window.setTimeout(look, 0);
  }

  private took(time: number, moving: boolean): void {
    if (!moving) {
      this.fine = time;
      if (time > kSlow) this.slow();
    } else if (time > kSlow) this.ratio = Math.max(kLeast, this.ratio * kStep);
    else if (time < kFast) this.ratio = Math.min(1, this.ratio / kStep);
  }
}
