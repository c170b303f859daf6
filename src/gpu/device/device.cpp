#include "gpu/device/device.h"

#include <sdm/error.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <mutex>
#include <utility>
#include <vector>

#include "core/memory.h"
#include "core/parse_number.h"

namespace sdm::gpu {
namespace {

std::string text(const WGPUStringView& view) {
  if (view.data == nullptr) return {};
  return view.length == WGPU_STRLEN ? std::string(view.data) : std::string(view.data, view.length);
}

WGPUStringView view(std::string_view text) {
  return {text.data(), text.size()};
}

// Never released: drivers may be gone when a process ends.
WGPUInstance instance() {
  static const WGPUInstance only = [] {
    WGPUInstanceExtras extras{};
    extras.chain.sType = static_cast<WGPUSType>(WGPUSType_InstanceExtras);
    extras.backends = WGPUInstanceBackend_Primary;
    WGPUInstanceDescriptor descriptor{};
    descriptor.nextInChain = &extras.chain;
    return wgpu().CreateInstance(&descriptor);
  }();
  if (only == nullptr) throw Error("the gpu engine: wgpu-native could not be started");
  return only;
}

struct Found {
  Adapter adapter;
  GpuDevice device{};
};

/// All adapters, those first that are no processors.
std::vector<Found> find_adapters() {
  WGPUInstanceEnumerateAdapterOptions options{};
  options.backends = WGPUInstanceBackend_Primary;
  std::vector<WGPUAdapter> all(wgpu().InstanceEnumerateAdapters(instance(), &options, nullptr));
  wgpu().InstanceEnumerateAdapters(instance(), &options, all.data());
  std::vector<Found> found;
  for (const WGPUAdapter adapter : all) {
    Found& each = found.emplace_back(Found{Adapter(adapter)});
    WGPUAdapterInfo info{};
    if (wgpu().AdapterGetInfo(adapter, &info) != WGPUStatus_Success) continue;
    each.device = {.name = text(info.device),
                   .driver = text(info.description),
                   .software = info.adapterType == WGPUAdapterType_CPU};
    wgpu().AdapterInfoFreeMembers(info);
  }
  if (found.empty())
    throw Error(
        "the gpu engine found no device with a driver for Vulkan, Metal or D3D12: install a driver (Debian: "
        "mesa-vulkan-drivers, which also computes on the processor), or use another engine");
  std::ranges::stable_partition(found, [](const Found& each) { return !each.device.software; });
  return found;
}

bool contains(std::string_view name, std::string_view wanted) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  return wanted.empty() || !std::ranges::search(name, wanted, same).empty();
}

Found choose(std::string_view wanted) {
  std::vector<Found> all = find_adapters();
  const auto number = core::parse_number<std::size_t>(wanted);
  const auto chosen =
      number
          ? all.begin() + static_cast<std::ptrdiff_t>(std::min(*number, all.size()))
          : std::ranges::find_if(all, [&](const Found& each) { return contains(each.device.name, wanted); });
  if (chosen != all.end()) return std::move(*chosen);
  std::string names;
  for (const Found& each : all) names += (names.empty() ? "" : ", ") + each.device.name;
  throw Error("the gpu engine found no device '" + std::string(wanted) + "'; there are: " + names);
}

constexpr std::size_t kUniformBytes = 16;

WGPUBufferUsage usage(Device::Use use) {
  switch (use) {
    case Device::Use::uniform:
      return WGPUBufferUsage_Uniform | WGPUBufferUsage_Storage | WGPUBufferUsage_CopyDst |
             WGPUBufferUsage_CopySrc;
    case Device::Use::read:
      return WGPUBufferUsage_Storage | WGPUBufferUsage_CopyDst;
    case Device::Use::write:
      return WGPUBufferUsage_Storage | WGPUBufferUsage_CopySrc;
    default:
      return WGPUBufferUsage_MapRead | WGPUBufferUsage_CopyDst;
  }
}

std::string megabytes(std::size_t bytes) {
  return std::to_string((bytes + 999'999) / 1'000'000) + " MB";
}

}  // namespace

std::vector<GpuDevice> devices_by_preference() {
  std::vector<GpuDevice> devices;
  for (Found& found : find_adapters()) devices.push_back(std::move(found.device));
  return devices;
}

// What the device has reported, from any thread.
struct Device::Faults {
  mutable std::mutex mutex;
  std::string lost, error;  // the first of each
  bool out_of_memory = false;

  static void on_lost(WGPUDevice const*, WGPUDeviceLostReason, WGPUStringView message, void* self, void*) {
    auto& faults = *static_cast<Faults*>(self);
    const std::lock_guard lock(faults.mutex);
    if (faults.lost.empty()) faults.lost = "it was lost (" + text(message) + ")";
  }
  static void on_error(WGPUDevice const*, WGPUErrorType type, WGPUStringView message, void* self, void*) {
    auto& faults = *static_cast<Faults*>(self);
    const std::lock_guard lock(faults.mutex);
    faults.out_of_memory |= type == WGPUErrorType_OutOfMemory;
    if (faults.error.empty()) faults.error = text(message);
  }
};

Device::Device(std::string_view wanted) : faults_(std::make_unique<Faults>()) {
  Found found = choose(wanted);
  name_ = std::move(found.device.name);
  software_ = found.device.software;
  WGPULimits limits{};
  if (wgpu().AdapterGetLimits(found.adapter.get(), &limits) != WGPUStatus_Success)
    throw Error("the gpu engine: " + name_ + " does not report its limits");
  most_bytes_ = std::min<std::size_t>(limits.maxStorageBufferBindingSize, limits.maxBufferSize);

  WGPUDeviceDescriptor descriptor{};
  descriptor.requiredLimits = &limits;
  descriptor.deviceLostCallbackInfo = {nullptr, WGPUCallbackMode_AllowSpontaneous, Faults::on_lost,
                                       faults_.get(), nullptr};
  descriptor.uncapturedErrorCallbackInfo = {nullptr, Faults::on_error, faults_.get(), nullptr};
  struct Answer {
    WGPUDevice device = nullptr;
    std::string message;
  } answer;
  const auto on_device = [](WGPURequestDeviceStatus, WGPUDevice device, WGPUStringView message, void* to,
                            void*) {
    *static_cast<Answer*>(to) = {device, text(message)};
  };
  // wgpu-native answers before it returns.
  wgpu().AdapterRequestDevice(found.adapter.get(), &descriptor,
                              {nullptr, WGPUCallbackMode_AllowSpontaneous, on_device, &answer, nullptr});
  if (answer.device == nullptr)
    throw Error("the gpu engine: " + name_ + " cannot be opened (" + answer.message + ")");
  device_.reset(answer.device);
  queue_.reset(wgpu().DeviceGetQueue(device_.get()));
}

Device::~Device() = default;

void Device::check(std::string_view step) const {
  const std::lock_guard lock(faults_->mutex);
  const std::string& fault = !faults_->lost.empty() ? faults_->lost : faults_->error;
  if (fault.empty()) return;
  const std::string what = faults_->lost.empty() && faults_->out_of_memory ? "not enough memory" : fault;
  throw Error("the gpu engine: " + name_ + " failed when " + std::string(step) + ": " + what);
}

Buffer Device::buffer(std::size_t bytes, Use use, std::string_view purpose) {
  bytes = std::max<std::size_t>((bytes + 3) / 4 * 4, kUniformBytes);
  if (bytes > most_bytes_)
    throw Error("the gpu engine needs a buffer of " + megabytes(bytes) + " for " + std::string(purpose) +
                ", and " + name_ + " permits " + megabytes(most_bytes_) + ": use the cpu engine");
  if (software_) require_memory(bytes, purpose);
  WGPUBufferDescriptor descriptor{};
  descriptor.usage = usage(use);
  descriptor.size = bytes;
  Buffer buffer(wgpu().DeviceCreateBuffer(device_.get(), &descriptor));
  check("it made a buffer of " + megabytes(bytes) + " for " + std::string(purpose));
  return buffer;
}

void Device::write(const Buffer& buffer, std::span<const std::byte> bytes) {
  wgpu().QueueWriteBuffer(queue_.get(), buffer.get(), 0, bytes.data(), bytes.size());
}

Pipeline Device::pipeline(std::initializer_list<EmbeddedFile> parts) {
  std::string wgsl;
  for (const EmbeddedFile& part : parts) wgsl += part.bytes;
  WGPUShaderSourceWGSL source{};
  source.chain.sType = WGPUSType_ShaderSourceWGSL;
  source.code = view(wgsl);
  WGPUShaderModuleDescriptor module_descriptor{};
  module_descriptor.nextInChain = &source.chain;
  const ShaderModule module(wgpu().DeviceCreateShaderModule(device_.get(), &module_descriptor));
  check("it compiled the program");
  WGPUComputePipelineDescriptor descriptor{};
  descriptor.compute.module = module.get();
  descriptor.compute.entryPoint = view("main");
  Pipeline pipeline(wgpu().DeviceCreateComputePipeline(device_.get(), &descriptor));
  check("it compiled the program");
  return pipeline;
}

BindGroup Device::bind(const Pipeline& pipeline, std::span<const Binding> bindings) {
  const BindGroupLayout layout(wgpu().ComputePipelineGetBindGroupLayout(pipeline.get(), 0));
  std::vector<WGPUBindGroupEntry> entries(bindings.size());
  for (std::size_t i = 0; i < bindings.size(); ++i) {
    entries[i].binding = bindings[i].number;
    entries[i].buffer = bindings[i].buffer->get();
    entries[i].size = WGPU_WHOLE_SIZE;
  }
  WGPUBindGroupDescriptor descriptor{};
  descriptor.layout = layout.get();
  descriptor.entryCount = entries.size();
  descriptor.entries = entries.data();
  BindGroup group(wgpu().DeviceCreateBindGroup(device_.get(), &descriptor));
  check("it bound buffers");
  return group;
}

CommandEncoder Device::record(std::span<const Step> steps) {
  CommandEncoder encoder(wgpu().DeviceCreateCommandEncoder(device_.get(), nullptr));
  if (steps.empty()) return encoder;
  const ComputePass pass(wgpu().CommandEncoderBeginComputePass(encoder.get(), nullptr));
  for (const Step& step : steps) {
    wgpu().ComputePassEncoderSetPipeline(pass.get(), step.pipeline->get());
    wgpu().ComputePassEncoderSetBindGroup(pass.get(), 0, step.group->get(), 0, nullptr);
    wgpu().ComputePassEncoderDispatchWorkgroups(pass.get(), step.workgroups, 1, 1);
  }
  wgpu().ComputePassEncoderEnd(pass.get());
  return encoder;
}

void Device::submit(const CommandEncoder& encoder) {
  const CommandBuffer commands(wgpu().CommandEncoderFinish(encoder.get(), nullptr));
  check("it was given work");
  const WGPUCommandBuffer list[] = {commands.get()};
  wgpu().QueueSubmit(queue_.get(), 1, list);
  check("it was given work");
}

void Device::run(std::span<const Step> steps) {
  submit(record(steps));
  wgpu().DevicePoll(device_.get(), true, nullptr);
  check("it computed");
}

void Device::run(std::span<const Step> steps, const Buffer& result, const Buffer& read_back,
                 std::span<std::byte> to) {
  const CommandEncoder encoder = record(steps);
  wgpu().CommandEncoderCopyBufferToBuffer(encoder.get(), result.get(), 0, read_back.get(), 0, to.size());
  submit(encoder);

  struct Answer {
    bool done = false;
    WGPUMapAsyncStatus status{};
    std::string message{};
  } answer;
  const auto on_mapped = [](WGPUMapAsyncStatus status, WGPUStringView message, void* user, void*) {
    *static_cast<Answer*>(user) = {true, status, text(message)};
  };
  wgpu().BufferMapAsync(read_back.get(), WGPUMapMode_Read, 0, to.size(),
                        {nullptr, WGPUCallbackMode_AllowSpontaneous, on_mapped, &answer, nullptr});
  // Callbacks run within a poll, on this thread.
  while (!answer.done) wgpu().DevicePoll(device_.get(), true, nullptr);
  check("it computed");
  if (answer.status != WGPUMapAsyncStatus_Success)
    throw Error("the gpu engine: " + name_ + " returned no result: " + answer.message);
  std::memcpy(to.data(), wgpu().BufferGetConstMappedRange(read_back.get(), 0, to.size()), to.size());
  wgpu().BufferUnmap(read_back.get());
}

void Device::lose() {
  wgpu().DeviceDestroy(device_.get());
}

}  // namespace sdm::gpu
