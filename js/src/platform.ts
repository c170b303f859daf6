// What browsers and Node have different interfaces for. No other file but those of Node names any of Node's modules, so that bundlers
// for browsers find none.

/** A worker, as it was started. */
export interface PlatformWorker {
  postMessage(message: unknown, transfer?: Transferable[]): void;
  /** Ends it, and tells nobody. */
  terminate(): void;
  /** One function at a time gets messages, and one why the worker ended. */
  listen(message: (message: any) => void, ended: (why: string) => void): void;
  /** In Node: whether the process waits for the worker. */
  hold(wait: boolean): void;
}

/** Of a worker, to the thread that started it. */
export interface Port {
  post(message: unknown, transfer?: Transferable[]): void;
  receive(receive: (message: any) => void): void;
}

export interface Platform {
  /** Starts a program. It need not be a module, so that it can come from a Blob. */
  start(script: string): PlatformWorker;
  port(): Port;
  load(url: URL): Promise<Response>;
  cores(): number;
}

const browser: Platform = {
  start(script) {
    const module = new URL(script, globalThis.location?.href).protocol !== 'blob:';
    const worker = new Worker(script, module ? { type: 'module' } : {});
    return {
      postMessage: (message, transfer = []) => worker.postMessage(message, transfer),
      terminate: () => {
        worker.onmessage = worker.onmessageerror = worker.onerror = null;
        worker.terminate();
      },
      listen: (message, ended) => {
        worker.onmessage = (event) => message(event.data);
        worker.onmessageerror = () => ended('the worker sent what cannot be read');
        worker.onerror = (event) => {
          event.preventDefault?.();
          ended(`the worker failed: ${event.message || 'its program cannot be loaded'}`);
        };
      },
      hold: () => {},
    };
  },
  port: () => ({
    post: (message, transfer = []) => self.postMessage(message, { transfer }),
    receive: (receive) => {
      self.onmessage = (event) => receive(event.data);
    },
  }),
  load: (url) => fetch(url),
  cores: () => navigator.hardwareConcurrency,
};

/** The global variable in which a worker of Node has its own. */
export const kGlobal = 'sdmPlatform';
let current = (globalThis as { [kGlobal]?: Platform })[kGlobal] ?? browser;

export const platform = (): Platform => current;
export function setPlatform(given: Platform): void {
  current = given;
}
