//! Buffers read back from the GPU.

use crate::render::gpu::device::Gpu;

/// Contents of a buffer; empty if the device is lost.
pub(crate) fn read(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<u8> {
    let read = gpu.empty_buffer("read", buffer.size(), wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &read, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    read.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    read.slice(..).get_mapped_range().map(|bytes| bytes.to_vec()).unwrap_or_default()
}
