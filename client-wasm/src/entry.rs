//! What the page's script calls.

use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

#[wasm_bindgen(js_namespace = ["window", "prairie"])]
extern "C" {
    /// Takes the page's message away.
    fn clear();
}

/// Starts the client on the canvas with this id.
///
/// # Errors
/// When the page has no such canvas, or WebGPU gives no adapter, device or surface.
#[wasm_bindgen]
pub async fn start(canvas_id: String) -> Result<(), JsError> {
    console_error_panic_hook::set_once();
    let document = web_sys::window().and_then(|window| window.document()).ok_or_else(|| JsError::new("no document"))?;
    let canvas = document.get_element_by_id(&canvas_id).and_then(|element| element.dyn_into::<HtmlCanvasElement>().ok());
    let canvas = canvas.ok_or_else(|| JsError::new(&format!("the page has no canvas with the id {canvas_id}")))?;
    paint(canvas).await?;
    clear();
    Ok(())
}

/// The client's state, as JSON.
#[wasm_bindgen]
pub fn state() -> String {
    "{}".into()
}

async fn paint(canvas: HtmlCanvasElement) -> Result<(), JsError> {
    let (width, height) = (canvas.client_width().unsigned_abs().max(1), canvas.client_height().unsigned_abs().max(1));
    canvas.set_width(width);
    canvas.set_height(height);
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let surface = instance.create_surface(wgpu::SurfaceTarget::Canvas(canvas))?;
    let options = wgpu::RequestAdapterOptions { compatible_surface: Some(&surface), ..Default::default() };
    let adapter = instance.request_adapter(&options).await?;
    let (device, queue) = adapter.request_device(&wgpu::DeviceDescriptor::default()).await?;
    let config = surface.get_default_config(&adapter, width, height).ok_or_else(|| JsError::new("the canvas takes no WebGPU surface"))?;
    surface.configure(&device, &config);
    let (wgpu::CurrentSurfaceTexture::Success(frame) | wgpu::CurrentSurfaceTexture::Suboptimal(frame)) = surface.get_current_texture()
    else {
        return Err(JsError::new("the canvas gave no texture"));
    };
    let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color { r: 0.2, g: 0.6, b: 0.4, a: 1.0 }),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..Default::default()
    });
    queue.submit([encoder.finish()]);
    queue.present(frame);
    Ok(())
}
