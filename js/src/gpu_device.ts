// A device of WebGPU that computes: its limits, buffers, programs and runs. Faults are one sentence each.
import { type ErrorKind, SdmError } from './types.js';

const kMostBytes = 2 ** 31; // of a buffer, as the module counts bytes in 32 bits

const megabytes = (bytes: number) => `${Math.ceil(bytes / 1e6)} MB`;
const fault = (kind: ErrorKind, text: string) => new SdmError(kind, `the engine gpu ${text}`);

/** A program of one entry point, `main`, and the workgroups that it runs. */
export interface Step {
  pipeline: GPUComputePipeline;
  group: GPUBindGroup;
  workgroups: number;
}

export class GpuDevice {
  /** The largest buffer that a program can read or write. */
  readonly mostBytes: number;
  /** Why it was lost. */
  private lost: string | undefined;

  constructor(
    readonly device: GPUDevice,
    /** Whether it computes on the processor. */
    readonly software: boolean,
  ) {
    const { maxStorageBufferBindingSize, maxBufferSize } = device.limits;
    this.mostBytes = Math.min(maxStorageBufferBindingSize, maxBufferSize, kMostBytes);
    void device.lost.then(({ message }) => (this.lost = message || 'for no stated reason'));
  }

  /** Throws SdmError if there is none. */
  static async open(): Promise<GpuDevice> {
    const { gpu } = (globalThis as { navigator?: { gpu?: GPU } }).navigator ?? {};
    if (!gpu) throw fault('input', "needs WebGPU, which is missing here: use the engine 'auto' or 'cpu'");
    const adapter = await gpu.requestAdapter({ powerPreference: 'high-performance' }).catch(() => null);
    if (!adapter)
      throw fault('input', "finds no device that WebGPU can use here: use the engine 'auto' or 'cpu'");
    const { maxStorageBufferBindingSize, maxBufferSize } = adapter.limits;
    try {
      const device = await adapter.requestDevice({
        requiredLimits: { maxStorageBufferBindingSize, maxBufferSize },
      });
      return new GpuDevice(device, adapter.info?.isFallbackAdapter === true);
    } catch (error) {
      throw fault('internal', `cannot open its device: ${(error as Error).message}`);
    }
  }

  /** Throws SdmError if a buffer may not be so large. Whether there is memory for it, the next run says. */
  buffer(bytes: number, usage: GPUBufferUsageFlags, purpose: string): GPUBuffer {
    const size = Math.max(16, Math.ceil(bytes / 4) * 4);
    if (size > this.mostBytes)
      throw fault(
        'memory',
        `needs a buffer of ${megabytes(size)} for ${purpose}, and the device permits ${megabytes(this.mostBytes)}: use the engine 'cpu'`,
      );
    return this.device.createBuffer({ size, usage });
  }

  write(buffer: GPUBuffer, bytes: GPUAllowSharedBufferSource): void {
    if (bytes.byteLength > 0) this.device.queue.writeBuffer(buffer, 0, bytes);
  }

  async pipeline(...sources: string[]): Promise<GPUComputePipeline> {
    const module = this.device.createShaderModule({ code: sources.join('\n') });
    try {
      return await this.device.createComputePipelineAsync({
        layout: 'auto',
        compute: { module, entryPoint: 'main' },
      });
    } catch (error) {
      throw this.failed('compiled a program', error);
    }
  }

  bind(pipeline: GPUComputePipeline, buffers: Record<number, GPUBuffer>): GPUBindGroup {
    return this.device.createBindGroup({
      layout: pipeline.getBindGroupLayout(0),
      entries: Object.entries(buffers).map(([binding, buffer]) => ({
        binding: +binding,
        resource: { buffer },
      })),
    });
  }

  /** Records the steps, each of which sees what those before it have written. */
  record(steps: Step[]): GPUCommandEncoder {
    const encoder = this.device.createCommandEncoder();
    const pass = encoder.beginComputePass();
    for (const { pipeline, group, workgroups } of steps) {
      pass.setPipeline(pipeline);
      pass.setBindGroup(0, group);
      pass.dispatchWorkgroups(workgroups);
    }
    pass.end();
    return encoder;
  }

  /** Calls `use`, and waits for what it starts. Throws SdmError, also for faults that WebGPU reports later. */
  async guarded<T>(step: string, use: () => T | Promise<T>): Promise<T> {
    const { device } = this;
    const kinds = ['validation', 'internal', 'out-of-memory'] as const;
    for (const kind of kinds) device.pushErrorScope(kind);
    let used: Promise<T>;
    try {
      used = Promise.resolve(use());
    } catch (error) {
      used = Promise.reject(error);
    }
    const reported = Promise.all(kinds.map(() => device.popErrorScope()));
    const [result, errors] = await Promise.allSettled([used, reported]);
    const reason = errors.status === 'fulfilled' ? errors.value.find((one) => one !== null) : undefined;
    if (!reason && result.status === 'fulfilled') return result.value;
    // That the device is lost is said after its calls have failed.
    await new Promise((resolve) => setTimeout(resolve));
    throw this.failed(step, reason ?? (result as PromiseRejectedResult).reason);
  }

  private failed(step: string, error: unknown): SdmError {
    if (error instanceof SdmError) return error;
    if (this.lost !== undefined) return fault('internal', `lost its device when it ${step}: ${this.lost}`);
    if (typeof GPUOutOfMemoryError === 'function' && error instanceof GPUOutOfMemoryError)
      return fault('memory', `has not enough memory on its device when it ${step}`);
    return fault('internal', `failed when it ${step}: ${(error as Error).message}`);
  }

  destroy(): void {
    this.device.destroy();
  }
}
