//! Changes to small files that keep most of their structure, so that they reach the code behind the first checks.

use proptest::prelude::*;
use serde_json::{Value, json};

/// One change: its place and kind, and a value; each file interprets them in its own way.
#[derive(Clone, Debug)]
pub(crate) struct Edit {
    pub(crate) at: usize,
    pub(crate) action: u8,
    pub(crate) value: usize,
}

/// One to four edits.
pub(crate) fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let edit = (any::<usize>(), any::<u8>(), any::<usize>()).prop_map(|(at, action, value)| Edit { at, action, value });
    prop::collection::vec(edit, 1..5)
}

/// JSON values that a reader of models may stumble over.
fn odd_json(value: usize) -> Value {
    let long = "x".repeat(3000);
    let odd = [
        json!(null),
        json!(true),
        json!(-1),
        json!(0),
        json!(1),
        json!(2),
        json!(3),
        json!(4),
        json!(7),
        json!(5121),
        json!(5123),
        json!(5125),
        json!(1_000_000_000),
        json!(u32::MAX),
        json!(u64::MAX),
        json!(1e39),
        json!(1e308),
        json!(0.5),
        json!(""),
        json!("SCALAR"),
        json!("MAT4"),
        json!("POSITION"),
        json!("data:;base64,AAAA"),
        json!("/dev/null"),
        json!(long),
        json!([]),
        json!([0]),
        json!([0, 1, 2]),
        json!({}),
        json!({ "POSITION": 9 }),
    ];
    odd[value % odd.len()].clone()
}

/// Replaces, removes or repeats one value.
pub(crate) fn json(root: &mut Value, Edit { at, action, value }: &Edit) {
    let mut paths = Vec::new();
    collect(root, String::new(), &mut paths);
    let path = &paths[at % paths.len()];
    let (parent, key) = path.rsplit_once('/').unwrap_or(("", ""));
    match (action % 4, root.pointer_mut(parent)) {
        (0, Some(Value::Object(fields))) => drop(fields.remove(key)),
        (0, Some(Value::Array(items))) => drop(key.parse().map(|index: usize| items.remove(index))),
        (1, Some(Value::Array(items))) => items.extend(items.clone()),
        _ => *root.pointer_mut(path).unwrap() = odd_json(*value),
    }
}

fn collect(value: &Value, path: String, paths: &mut Vec<String>) {
    match value {
        Value::Array(items) => items.iter().enumerate().for_each(|(i, item)| collect(item, format!("{path}/{i}"), paths)),
        Value::Object(fields) => fields.iter().for_each(|(key, field)| collect(field, format!("{path}/{key}"), paths)),
        _ => {}
    }
    paths.push(path);
}

/// Changes, removes or repeats bytes of a chunk, and then mends the checksums; with the largest action it only mends.
pub(crate) fn png(file: &mut Vec<u8>, Edit { at, action, value }: &Edit) {
    const SIGNATURE: usize = 8;
    let at = SIGNATURE + at % (file.len() - SIGNATURE);
    let odd = [0, 1, 2, 3, 4, 6, 8, 16, 127, 128, 255][value % 11];
    match *action {
        u8::MAX => {}
        0..16 => file.truncate(at.max(SIGNATURE + 1)),
        16..32 => {
            let repeated = file[at..].to_vec();
            file.extend(repeated);
        }
        _ => file[at] = odd,
    }
    mend_checksums(file);
}

fn mend_checksums(file: &mut [u8]) {
    let mut start = 8;
    while let Some(length) = file.get(start..start + 4) {
        let length = u32::from_be_bytes(length.try_into().unwrap()) as usize;
        let Some(end) = start.checked_add(8 + length).filter(|end| end + 4 <= file.len()) else { return };
        let checksum = crc(&file[start + 4..end]);
        file[end..end + 4].copy_from_slice(&checksum.to_be_bytes());
        start = end + 4;
    }
}

/// The checksum of PNG chunks, CRC-32.
fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _: u8| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

/// Numbers, words and lists that a reader of scenes may stumble over.
const ODD_TOML: [&str; 26] = [
    "0",
    "-1",
    "1",
    "2",
    "8",
    "16",
    "64",
    "255",
    "0.05",
    "1e-12",
    "1e9",
    "1e308",
    "-0.0",
    "nan",
    "inf",
    "9223372036854775807",
    "true",
    "\"\"",
    "\"wrap\"",
    "\"free-slip\"",
    "\"swirl\"",
    "\"height.png\"",
    "[]",
    "[0, 0]",
    "[[0, 0]]",
    "1979-05-27",
];

/// Changes the value of a line, or one number in it, or removes, repeats or moves the line, or changes a byte.
pub(crate) fn lines(text: &mut Vec<u8>, Edit { at, action, value }: &Edit) {
    if action % 16 == 15 && !text.is_empty() {
        let at = at % text.len();
        text[at] = *value as u8;
        return;
    }
    let whole = String::from_utf8_lossy(text).into_owned();
    let mut lines: Vec<_> = whole.lines().map(str::to_owned).collect();
    if lines.is_empty() {
        return;
    }
    let at = at % lines.len();
    let odd = ODD_TOML[value % ODD_TOML.len()];
    match action % 8 {
        0 => drop(lines.remove(at)),
        1 => {
            let repeated = lines[value % lines.len()].clone();
            lines.insert(at, repeated);
        }
        2 => {
            let other = value % lines.len();
            lines.swap(at, other);
        }
        3..6 => {
            let key = lines[at].split(" = ").next().unwrap_or_default().to_owned();
            lines[at] = format!("{key} = {odd}");
        }
        _ => {
            let end = lines[at].rfind(|c: char| c.is_ascii_digit()).map_or(lines[at].len(), |end| end + 1);
            let start = lines[at][..end].rfind(|c: char| !(c.is_ascii_digit() || c == '.')).map_or(0, |start| start + 1);
            lines[at].replace_range(start..end, odd);
        }
    }
    *text = lines.join("\n").into_bytes();
}
