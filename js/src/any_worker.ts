// Workers of browsers and of Node, which have different interfaces.
import { SdmError } from './types.js';

export interface AnyWorker {
  postMessage(message: unknown, transfer?: Transferable[]): void;
  /** Ends it, and tells nobody. */
  terminate(): void;
  /** One function at a time gets messages, and one what ended the worker. */
  listen(message: (message: any) => void, ended: (error: SdmError) => void): void;
  /** In Node: whether the process waits for the worker. */
  hold(wait: boolean): void;
}

const kStartMilliseconds = 60000;

function ofBrowser(worker: Worker): AnyWorker {
  return {
    postMessage: (message, transfer = []) => worker.postMessage(message, transfer),
    terminate: () => {
      worker.onmessage = worker.onmessageerror = worker.onerror = null;
      worker.terminate();
    },
    listen: (message, ended) => {
      worker.onmessage = (event) => message(event.data);
      worker.onmessageerror = () => ended(new SdmError('ended', 'the worker sent what cannot be read'));
      worker.onerror = (event) => {
        event.preventDefault?.();
        ended(new SdmError('ended', `the worker failed: ${event.message || 'its program cannot be loaded'}`));
      };
    },
    hold: () => {},
  };
}

/** Starts a program in a worker. It need not be a module, so that it can come from a Blob. Throws SdmError if there is none. */
export async function newWorker(script: string): Promise<AnyWorker> {
  try {
    return await begun(script);
  } catch (error) {
    throw new SdmError(
      'ended',
      `the worker ${script} cannot be started: ${error instanceof Error ? error.message : error}`,
    );
  }
}

async function begun(script: string): Promise<AnyWorker> {
  if (typeof Worker === 'function') {
    const module = new URL(script, globalThis.location?.href).protocol !== 'blob:';
    return ofBrowser(new Worker(script, module ? { type: 'module' } : {}));
  }
  const { Worker: NodeWorker } = await import('node:worker_threads');
  const worker = new NodeWorker(new URL(script));
  worker.unref();
  let ended = (_: SdmError) => {};
  let message = (_: unknown) => {};
  worker.on('message', (sent) => message(sent));
  worker.on('error', (error) =>
    ended(new SdmError('ended', `the worker failed: ${error instanceof Error ? error.message : error}`)),
  );
  worker.on('exit', () => ended(new SdmError('ended', 'the worker has ended')));
  return {
    postMessage: (sent, transfer = []) => worker.postMessage(sent, transfer as never),
    terminate: () => {
      ended = message = () => {};
      void worker.terminate();
    },
    listen: (onMessage, onEnd) => {
      message = onMessage;
      ended = onEnd;
    },
    hold: (wait) => (wait ? worker.ref() : worker.unref()),
  };
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
