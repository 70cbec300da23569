use super::shaders;
use super::uniforms::{Frame, Plants};
use wgpu::naga;

fn module(source: &str) -> naga::Module {
    let text = shaders::whole(source);
    let module = naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
    let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    if let Err(error) = validator.validate(&module) {
        panic!("{}", error.emit_to_string(&text));
    }
    module
}

#[test]
fn every_shader_is_valid_wgsl_without_extensions() {
    for source in [
        shaders::BEND,
        shaders::BLADES,
        shaders::FLOWERS,
        shaders::BILLBOARDS,
        shaders::TERRAIN,
        shaders::OBJECTS,
        shaders::SKY,
        shaders::TONE,
    ] {
        module(source);
    }
}

fn assert_twins(module: &naga::Module, name: &str, layout: &[(&str, usize)], size: usize) {
    let (_, twin) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).expect("the twin is there");
    let naga::TypeInner::Struct { members, span } = &twin.inner else { panic!("{name} is no struct") };
    let found: Vec<_> = members.iter().map(|member| (member.name.as_deref().unwrap_or_default(), member.offset as usize)).collect();
    assert_eq!(found, layout, "{name}");
    assert_eq!(*span as usize, size, "{name}");
}

#[test]
fn uniform_blocks_lie_as_their_twins() {
    let module = module(shaders::BEND);
    assert_twins(&module, "Frame", Frame::LAYOUT, size_of::<Frame>());
    assert_twins(&module, "Plants", Plants::LAYOUT, size_of::<Plants>());
}
