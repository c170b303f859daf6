// The interfaces of Node.
import { readFile } from 'node:fs/promises';
import { availableParallelism } from 'node:os';
import { Worker, parentPort } from 'node:worker_threads';
import { type Platform } from './platform.js';

export const node: Platform = {
  start(script) {
    const worker = new Worker(new URL('./node_worker.js', import.meta.url), {
      workerData: String(new URL(script)),
    });
    worker.unref();
    let ended = (_: string) => {};
    let message = (_: unknown) => {};
    worker.on('message', (sent) => message(sent));
    worker.on('error', (error) =>
      ended(`the worker failed: ${error instanceof Error ? error.message : error}`),
    );
    worker.on('exit', () => ended('the worker has ended'));
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
  },
  port: () => ({
    post: (message, transfer = []) => parentPort!.postMessage(message, transfer as never),
    receive: (receive) => void parentPort!.removeAllListeners('message').on('message', receive),
  }),
  load: async (url) => (url.protocol === 'file:' ? new Response(await readFile(url)) : fetch(url)),
  cores: availableParallelism,
};
