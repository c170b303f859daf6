// Why a thread of a module has failed, in memory that all of its threads share: messages reach nobody, as the others wait for it.

const kReasonBytes = 1000;
/** Words before the text: whether there is an author, and 1 + the bytes of the text once that is written. */
const [kAuthor, kWritten, kWords] = [0, 1, 2];

export class Failure {
  private readonly words: Int32Array;
  private readonly text: Uint8Array;

  constructor(readonly memory = new SharedArrayBuffer(4 * kWords + kReasonBytes)) {
    this.words = new Int32Array(memory, 0, kWords);
    this.text = new Uint8Array(memory, 4 * kWords);
  }

  /** The reason stays that of the thread that has failed first. */
  set(reason: string): void {
    if (Atomics.compareExchange(this.words, kAuthor, 0, 1) !== 0) return;
    const bytes = new TextEncoder().encode(reason).subarray(0, kReasonBytes);
    this.text.set(bytes);
    Atomics.store(this.words, kWritten, 1 + bytes.length);
  }

  /** Undefined while no thread has failed. */
  get reason(): string | undefined {
    const written = Atomics.load(this.words, kWritten);
    // A copy, as text in shared memory is not decoded.
    return written === 0 ? undefined : new TextDecoder().decode(this.text.slice(0, written - 1));
  }
}
