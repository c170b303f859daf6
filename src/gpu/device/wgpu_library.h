// The functions of wgpu-native, which implements WebGPU for programs. Its library is loaded when it is first
// needed.
#pragma once

#include <wgpu.h>

#include <memory>

// The functions in use, by their names without "wgpu".
#define SDM_WGPU_FUNCTIONS(F)             \
  F(CreateInstance)                       \
  F(InstanceEnumerateAdapters)            \
  F(AdapterGetInfo)                       \
  F(AdapterGetLimits)                     \
  F(AdapterInfoFreeMembers)               \
  F(AdapterRequestDevice)                 \
  F(AdapterRelease)                       \
  F(DeviceGetQueue)                       \
  F(DevicePoll)                           \
  F(DeviceCreateBuffer)                   \
  F(DeviceCreateShaderModule)             \
  F(DeviceCreateComputePipeline)          \
  F(DeviceCreateBindGroup)                \
  F(DeviceCreateCommandEncoder)           \
  F(DeviceDestroy)                        \
  F(DeviceRelease)                        \
  F(QueueWriteBuffer)                     \
  F(QueueSubmit)                          \
  F(QueueRelease)                         \
  F(BufferMapAsync)                       \
  F(BufferGetConstMappedRange)            \
  F(BufferUnmap)                          \
  F(BufferRelease)                        \
  F(ShaderModuleRelease)                  \
  F(ComputePipelineGetBindGroupLayout)    \
  F(ComputePipelineRelease)               \
  F(BindGroupLayoutRelease)               \
  F(BindGroupRelease)                     \
  F(CommandEncoderBeginComputePass)       \
  F(CommandEncoderCopyBufferToBuffer)     \
  F(CommandEncoderFinish)                 \
  F(CommandEncoderRelease)                \
  F(CommandBufferRelease)                 \
  F(ComputePassEncoderSetPipeline)        \
  F(ComputePassEncoderSetBindGroup)       \
  F(ComputePassEncoderDispatchWorkgroups) \
  F(ComputePassEncoderEnd)                \
  F(ComputePassEncoderRelease)

namespace sdm::gpu {

struct Wgpu {
#define SDM_WGPU_MEMBER(name) decltype(&wgpu##name) name = nullptr;
  SDM_WGPU_FUNCTIONS(SDM_WGPU_MEMBER)
#undef SDM_WGPU_MEMBER
};

/// Loads libwgpu_native.so when called first. Throws sdm::Error if it is missing, or lacks one of the
/// functions.
[[nodiscard]] const Wgpu& wgpu();

/// Owns an object of WebGPU. There are none before the library is loaded.
template <auto Release>
struct Releaser {
  template <class Object>
  void operator()(Object* object) const {
    (wgpu().*Release)(object);
  }
};
using Adapter = std::unique_ptr<WGPUAdapterImpl, Releaser<&Wgpu::AdapterRelease>>;
using Queue = std::unique_ptr<WGPUQueueImpl, Releaser<&Wgpu::QueueRelease>>;
using Buffer = std::unique_ptr<WGPUBufferImpl, Releaser<&Wgpu::BufferRelease>>;
using ShaderModule = std::unique_ptr<WGPUShaderModuleImpl, Releaser<&Wgpu::ShaderModuleRelease>>;
using Pipeline = std::unique_ptr<WGPUComputePipelineImpl, Releaser<&Wgpu::ComputePipelineRelease>>;
using BindGroupLayout = std::unique_ptr<WGPUBindGroupLayoutImpl, Releaser<&Wgpu::BindGroupLayoutRelease>>;
using BindGroup = std::unique_ptr<WGPUBindGroupImpl, Releaser<&Wgpu::BindGroupRelease>>;
using CommandEncoder = std::unique_ptr<WGPUCommandEncoderImpl, Releaser<&Wgpu::CommandEncoderRelease>>;
using CommandBuffer = std::unique_ptr<WGPUCommandBufferImpl, Releaser<&Wgpu::CommandBufferRelease>>;
using ComputePass = std::unique_ptr<WGPUComputePassEncoderImpl, Releaser<&Wgpu::ComputePassEncoderRelease>>;

}  // namespace sdm::gpu
