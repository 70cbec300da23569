//! A glTF file with its buffers, and checks that the `gltf` readers leave to their callers.

use super::{FILE_LIMIT, ModelFault};
use crate::file;
use data_encoding::BASE64_NOPAD;
use gltf::accessor::{DataType, Dimensions};
use gltf::json::Index;
use gltf::json::validation::Checked;
use gltf::{Accessor, Document, Gltf, Semantic, binary, buffer};
use prairie_core::escape::excerpt;
use std::path::{Path, PathBuf};

/// Length of a binary file's header (bytes).
const HEADER_BYTES: u32 = 12;

/// A document and its buffers.
pub(super) struct Source {
    pub(super) document: Document,
    pub(super) buffers: Vec<Vec<u8>>,
    /// Files of buffers beside the document.
    pub(super) buffer_files: Vec<PathBuf>,
}

/// Allowed types of an attribute or of indices.
pub(super) struct Role {
    name: &'static str,
    shapes: &'static [Dimensions],
    types: &'static [DataType],
}

pub(super) const POSITION: Role = Role { name: "POSITION", shapes: &[Dimensions::Vec3], types: &[DataType::F32] };
pub(super) const NORMAL: Role = Role { name: "NORMAL", shapes: &[Dimensions::Vec3], types: &[DataType::F32] };
pub(super) const COLOUR: Role =
    Role { name: "COLOR_0", shapes: &[Dimensions::Vec3, Dimensions::Vec4], types: &[DataType::F32, DataType::U8, DataType::U16] };
pub(super) const INDICES: Role =
    Role { name: "indices", shapes: &[Dimensions::Scalar], types: &[DataType::U8, DataType::U16, DataType::U32] };

impl Source {
    pub(super) fn open(path: &Path) -> Result<Self, ModelFault> {
        let bytes = file::read(path, FILE_LIMIT).map_err(ModelFault::Unreadable)?;
        let (document, mut blob) = parse(&bytes)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let (mut buffers, mut buffer_files) = (Vec::new(), Vec::new());
        let mut held = 0;
        for buffer in document.buffers() {
            let bytes = match buffer.source() {
                buffer::Source::Bin => blob.take().ok_or_else(|| ModelFault::NotGltf("it has no binary part".to_owned()))?,
                buffer::Source::Uri(uri) => at_uri(uri, folder, &mut buffer_files)?,
            };
            if bytes.len() < buffer.length() {
                let (index, stated) = (buffer.index(), buffer.length());
                return Err(ModelFault::NotGltf(format!("buffer {index} is stated to have {stated} bytes and has {}", bytes.len())));
            }
            held += bytes.len() as u64;
            if held > FILE_LIMIT {
                return Err(ModelFault::TooLarge { what: "bytes in its buffers", limit: FILE_LIMIT as usize });
            }
            buffers.push(bytes);
        }
        Ok(Self { document, buffers, buffer_files })
    }

    /// Number of the accessor's values, after checking them. The readers of `gltf` panic for unknown types and for a stride shorter than a value, so
    /// this must come first.
    pub(super) fn count(&self, role: &Role, accessor: Option<Accessor<'_>>) -> Result<Option<usize>, ModelFault> {
        let Some(accessor) = accessor else { return Ok(None) };
        let (shape, data_type) = (accessor.dimensions(), accessor.data_type());
        if !(role.shapes.contains(&shape) && role.types.contains(&data_type)) {
            let found = format!("{shape:?} of {data_type:?}");
            let allowed = format!("{} of {}", any_of(role.shapes), any_of(role.types));
            return Err(ModelFault::Kind { what: role.name, found, allowed });
        }
        if accessor.sparse().is_none() && self.holds(&accessor) { Ok(Some(accessor.count())) } else { Err(ModelFault::Outside(role.name)) }
    }

    /// Whether all values are within the accessor's view, and the view within its buffer.
    fn holds(&self, accessor: &Accessor<'_>) -> bool {
        let Some(view) = accessor.view() else { return false };
        let stride = view.stride().unwrap_or(accessor.size());
        let end = |start: usize, length: usize| start.checked_add(length);
        let last = accessor.count().checked_sub(1).and_then(|before| before.checked_mul(stride)).and_then(|at| end(at, accessor.offset()));
        stride >= accessor.size()
            && last.and_then(|last| end(last, accessor.size())).is_some_and(|end| end <= view.length())
            && end(view.offset(), view.length()).is_some_and(|end| end <= self.buffers[view.buffer().index()].len())
    }
}

/// Parses and validates a file, after checks of the two places where `gltf` itself panics.
fn parse(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), ModelFault> {
    if let Some(length) = stated_length(bytes).filter(|&length| length < HEADER_BYTES) {
        return Err(ModelFault::NotGltf(format!("its header states a length of {length} bytes; allowed: at least {HEADER_BYTES}")));
    }
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(not_gltf)?;
    let root = document.into_json();
    let accessors = root.accessors.len();
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions)).map(Index::value);
            if let Some(index) = position.filter(|&index| index >= accessors) {
                return Err(ModelFault::NotGltf(format!(
                    "meshes[{m}].primitives[{p}].attributes.POSITION is {index}, and there are {accessors} accessors, numbered from 0"
                )));
            }
        }
    }
    Ok((Document::from_json(root).map_err(not_gltf)?, blob))
}

/// Length that the header of a binary file states (bytes).
fn stated_length(bytes: &[u8]) -> Option<u32> {
    let length = bytes.strip_prefix(b"glTF")?.get(4..8)?;
    Some(u32::from_le_bytes(length.try_into().ok()?))
}

/// The bytes that a URI names; the path of a file is added to `files`.
fn at_uri(uri: &str, folder: &Path, files: &mut Vec<PathBuf>) -> Result<Vec<u8>, ModelFault> {
    let unfit = |uri: &str, reason: String| ModelFault::Buffer { uri: excerpt(uri), reason };
    if let Some(data) = uri.strip_prefix("data:") {
        let digits = data.split_once(";base64,").map_or(data, |(_media_type, digits)| digits).trim_end_matches('=');
        return BASE64_NOPAD.decode(digits.as_bytes()).map_err(|error| unfit("data:…", format!("is not base64: {error}")));
    }
    let name = urlencoding::decode(uri).map_err(|error| unfit(uri, format!("is not a file name: {error}")))?;
    if name.contains("://") {
        return Err(unfit(uri, "is elsewhere; allowed: a path relative to the model, or data within it".to_owned()));
    }
    let path = folder.join(name.as_ref());
    let bytes = file::read(&path, FILE_LIMIT).map_err(|reason| unfit(uri, format!("cannot be read: {reason}")))?;
    files.push(path);
    Ok(bytes)
}

fn not_gltf(error: gltf::Error) -> ModelFault {
    use binary::Error::{ChunkLength, Io, Length};
    ModelFault::NotGltf(match error {
        gltf::Error::Io(_) | gltf::Error::Binary(Io(_) | Length { .. } | ChunkLength { .. }) => "it ends too early".to_owned(),
        gltf::Error::Validation(errors) => {
            errors.first().map_or_else(String::new, |(path, error)| format!("{} is wrong ({error})", excerpt(path.as_str())))
        }
        // Errors of JSON may quote a value of any length.
        other => excerpt(&other.to_string()),
    })
}

fn any_of(kinds: &[impl std::fmt::Debug]) -> String {
    kinds.iter().map(|kind| format!("{kind:?}")).collect::<Vec<_>>().join(" or ")
}
