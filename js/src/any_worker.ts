// Workers of browsers and of Node.
import { type PlatformWorker, platform } from './platform.js';
import { SdmError } from './types.js';

export interface AnyWorker extends Omit<PlatformWorker, 'listen'> {
  listen(message: (message: any) => void, ended: (error: SdmError) => void): void;
}

const kStartMilliseconds = 60000;

/** Starts a program in a worker. Throws SdmError if there is none. */
export function newWorker(script: string): AnyWorker {
  try {
    const worker = platform().start(script);
    return {
      ...worker,
      listen: (message, ended) => worker.listen(message, (why) => ended(new SdmError('ended', why))),
    };
  } catch (error) {
    throw new SdmError(
      'ended',
      `the worker ${script} cannot be started: ${error instanceof Error ? error.message : error}`,
    );
  }
}

/**
 * Sends the first message and returns the answer. Throws SdmError, and ends the worker, if it cannot be started; throws the reason of
 * the signal if that is aborted before.
 */
export async function started<Answer>(
  worker: AnyWorker,
  message: unknown,
  signal?: AbortSignal,
): Promise<Answer> {
  worker.hold(true);
  let timer: ReturnType<typeof setTimeout> | undefined;
  try {
    return await new Promise<Answer>((resolve, reject) => {
      worker.listen(
        (answer: { failed?: string } & Answer) =>
          answer.failed !== undefined ? reject(new SdmError('internal', answer.failed)) : resolve(answer),
        reject,
      );
      signal?.addEventListener('abort', () => reject(signal.reason), { once: true });
      timer = setTimeout(
        () => reject(new SdmError('ended', 'the worker does not answer: is its program worker.js?')),
        kStartMilliseconds,
      );
      worker.postMessage(message);
    });
  } catch (error) {
    worker.terminate();
    throw error;
  } finally {
    clearTimeout(timer);
    worker.hold(false);
  }
}
