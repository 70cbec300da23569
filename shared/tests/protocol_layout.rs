//! The layout of every type on the wire, for programs in other languages: `server/docs/protocol.json`, generated from the types.

use prairie_core::bend::{Edges, GroundContact, Scheme, Seams};
use prairie_core::scene::{
    BladeIntegrator, BladeShape, ComponentKind, FlowerShape, LagWay, ObjectContact, PlantCover, PrimitiveIntensity, PrimitiveKind,
    ShellExtrusion, TreeShape, VehicleKind, WindAdvection, WindBoundary, WindDiffusion, WindMethod, WindPressure, WindTerrain, WindTiling,
    WindTime,
};
use prairie_core::wire::{ClientMessage, ModelUse, PROTOCOL, Refusal, ServerMessage};
use serde_json::{Value, json};
use serde_reflection::{Samples, Tracer, TracerConfig};
use std::path::Path;

/// The layouts of all types by name, in the format of `serde-reflection`.
fn generated() -> Value {
    // The byte 0 is not a valid heading.
    let mut tracer = Tracer::new(TracerConfig::default().default_u8_value(1));
    let samples = Samples::new();
    // The enums inside messages first: of an enum inside another type the tracer sees one variant at a time.
    macro_rules! trace {
        ($($name:ident),+) => {
            $(tracer.trace_type::<$name>(&samples).expect(concat!(stringify!($name), " describes itself"));)+
        };
    }
    trace!(
        BladeIntegrator,
        BladeShape, ComponentKind, Edges, FlowerShape, GroundContact, LagWay, ObjectContact, PlantCover, PrimitiveIntensity
    );
    trace!(PrimitiveKind, Refusal, Scheme, Seams, ShellExtrusion, TreeShape, VehicleKind);
    trace!(WindAdvection, WindBoundary, WindDiffusion, WindMethod, WindPressure, WindTerrain, WindTiling, WindTime);
    trace!(ModelUse, ClientMessage, ServerMessage);
    let types = tracer.registry().expect("every enum inside a message is in the list above");
    let mut layout = json!({ "protocol": PROTOCOL, "types": types });
    layout.sort_all_objects();
    layout
}

#[test]
fn the_stored_layout_is_the_generated_one() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../server/docs/protocol.json");
    if std::env::var_os("PRAIRIE_UPDATE").is_some() {
        std::fs::write(&path, format!("{:#}\n", generated())).unwrap();
    }
    let stored: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    assert!(stored == generated(), "server/docs/protocol.json is old; run again with PRAIRIE_UPDATE=1");
}

/// Every variant of a message has a row with its number and the names of its fields.
#[test]
fn the_page_lists_every_message() {
    let (page, layout) = (include_str!("../../server/docs/protocol.md"), generated());
    for message in ["ClientMessage", "ServerMessage"] {
        for (number, variant) in layout["types"][message]["ENUM"].as_object().expect("messages are enums") {
            let (name, content) = variant.as_object().and_then(|variant| variant.iter().next()).expect("a variant has a name");
            let start = format!("| {number} | `{name}` |");
            let row = page.lines().find(|line| line.starts_with(&start)).unwrap_or_else(|| panic!("docs/protocol.md lacks a row {start}"));
            let fields = content["STRUCT"].as_array().into_iter().flatten().filter_map(Value::as_object).flat_map(|field| field.keys());
            for field in fields {
                assert!(row.contains(&format!("`{field}`")), "docs/protocol.md lacks the field {field} of {name}");
            }
        }
    }
}
