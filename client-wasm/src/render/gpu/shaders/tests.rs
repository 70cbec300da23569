use super::{ALL, FROM_RUST, write_lines};
use link::{Library, Piece};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use wgpu::naga;

#[path = "../../../../build/link.rs"]
#[allow(dead_code, reason = "the build script uses the rest")]
mod link;

/// The module of a WGSL text, or an error message with file and line.
pub(crate) fn parsed(text: &str) -> Result<naga::Module, String> {
    let at = |line: Option<naga::SourceLocation>, message: String| {
        let line = line.and_then(|line| text.lines().nth(line.line_number as usize - 1)).unwrap_or_default();
        format!("{}: {message}", line.rsplit_once(" // ").map_or(line, |(_, from)| from))
    };
    let module = naga::front::wgsl::parse_str(text).map_err(|error| at(error.location(text), error.emit_to_string(text)))?;
    let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    validator.validate(&module).map_err(|error| at(error.location(text), error.emit_to_string(text)))?;
    Ok(module)
}

fn from_rust(name: &str) -> super::Piece {
    FROM_RUST.iter().find(|(other, _)| *other == name).unwrap_or_else(|| panic!("no shader has {name} from Rust")).1
}

fn texts() -> Vec<(String, String)> {
    link::files(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders"))).expect("the folder of shaders")
}

fn joined(pieces: Vec<Piece<'_>>) -> String {
    let (mut text, mut declared) = (String::new(), Vec::new());
    for piece in pieces {
        let written = match piece {
            Piece::Wgsl(file, one) => write_lines(&mut text, file, one.line, &one.text),
            Piece::Rust(_, name) => from_rust(name).declare(&mut declared, &mut text),
        };
        written.expect("a string takes all");
    }
    text
}

/// WGSL of a test, linked with the declarations that it uses from one file and from all files that are not passes.
pub(crate) fn linked(file: &str, source: &str) -> String {
    let library = Library::new(texts()).unwrap_or_else(|error| panic!("{error}"));
    let passes = library.passes();
    let usable = library.0.iter().filter(|(path, _)| !passes.contains(&path.as_str()));
    let usable = usable.chain(library.0.get_key_value(file));
    let declared = usable.flat_map(|(path, file)| file.declarations.iter().map(move |one| (one.name.as_str(), path.as_str())));
    let names: BTreeMap<_, _> = library.imports_from_rust().map(|(module, name)| (name, module)).chain(declared).collect();
    // Struct members are not separate words.
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let words: BTreeSet<_> = source.split(|c| !is_part(c)).filter_map(|word| word.split('.').next()).collect();
    let used = names.iter().filter(|(name, _)| words.contains(*name));
    let imports: String = used.map(|(name, path)| format!("import package::{}::{name};", path.replace('/', "::"))).collect();
    let test = ("test".to_owned(), format!("{imports}{source}"));
    let library = Library::new(texts().into_iter().chain([test])).unwrap_or_else(|error| panic!("{error}"));
    joined(library.link("test").unwrap_or_else(|error| panic!("{error}")))
}

/// First error, of the linker or of a pass, after a change to one file.
fn error_with(file: &str, change: impl Fn(&str) -> String) -> Option<String> {
    let texts = texts().into_iter().map(|(path, text)| if path == file { (path, change(&text)) } else { (path, text) });
    let library = match Library::new(texts) {
        Ok(library) => library,
        Err(error) => return Some(error.to_string()),
    };
    library.passes().iter().find_map(|pass| match library.link(pass) {
        Ok(pieces) => parsed(&joined(pieces)).err(),
        Err(error) => Some(error.to_string()),
    })
}

#[test]
fn passes_are_linked_from_their_files() {
    let library = Library::new(texts()).expect("sound shaders");
    assert_eq!(library.passes(), ALL.iter().map(|shader| shader.file).collect::<Vec<_>>());
    for shader in ALL {
        assert_eq!(shader.to_string(), joined(library.link(shader.file).expect("a pass")), "{}", shader.file);
    }
}

#[test]
fn each_file_is_valid_with_what_it_imports() {
    let library = Library::new(texts()).expect("sound shaders");
    for file in library.0.keys() {
        let unit = joined(library.unit(file).unwrap_or_else(|error| panic!("{error}")));
        parsed(&unit).unwrap_or_else(|error| panic!("{file}: {error}"));
    }
}

#[test]
fn an_error_names_its_own_file_and_line() {
    assert_eq!(error_with("none", str::to_owned), None);
    let lines = |file: &str| texts().into_iter().find(|(path, _)| path == file).expect("a file").1.lines().count();
    // Planted at the start of function bodies: a value of the wrong type, an undeclared name, and a missing expression.
    for (planted, message) in [("var x: i32 = 1.5;", "i32"), ("let x = nothing;", "nothing"), ("let x = ;", "expression")] {
        for file in ["inputs/wind", "land_and_sky/tone", "plants/sift"] {
            let error = error_with(file, |text| text.replace("{\n    let ", &format!("{{ {planted}\n    let ")));
            let text = texts().into_iter().find(|(path, _)| path == file).expect("a file").1;
            let line = text
                .lines()
                .zip(text.lines().skip(1))
                .position(|(a, b)| a.ends_with('{') && b.starts_with("    let "))
                .expect("a function");
            let error = error.unwrap_or_else(|| panic!("{planted} in {file}"));
            assert!(error.contains(message), "{error}");
            let first = error.split_once(": ").expect("a message").0;
            assert!(
                first.strip_prefix(&format!("{file}.wgsl:")).is_some_and(|at| at.parse::<usize>().is_ok_and(|at| at > line)),
                "{error} before line {line}"
            );
        }
    }
    for (appended, message) in [
        ("fn planted() { later(); }\nfn later() { wave(2.0); }\nfn wave(x: f32) {", "no end"),
        ("fn planted() -> f32 { return\n    backbone_at(); }", "`backbone_at` is declared in plants/backbone but not imported"),
        ("import package::plants::backbone::{WIDER};", "`WIDER` is imported but not used"),
        ("import package::plants::backbone::nothing;", "plants/backbone declares no `nothing`"),
        ("import package::nowhere::nothing;", "nowhere declares no `nothing`"),
        ("const TAU: f32 = 6.0;", "`TAU` is declared twice"),
    ] {
        let error = error_with("inputs/frustum", |text| {
            format!("import package::constants::TAU;\n{text}fn turn() -> f32 {{ return TAU; }}\n{appended}")
        });
        let error = error.unwrap_or_else(|| panic!("{appended}"));
        assert!(error.contains(message), "{error}");
        let at = lines("inputs/frustum") + 3 + appended.lines().count() - 1;
        assert!(error.starts_with(&format!("inputs/frustum.wgsl:{at}: ")), "{error} instead of line {at}");
    }
}

#[test]
fn uniform_blocks_are_laid_out_as_in_wgsl() {
    let blocks = FROM_RUST.iter().filter_map(|(_, piece)| if let super::Piece::Block(block) = piece { Some(*block) } else { None });
    let mut count = 0;
    for block in blocks {
        let mut text = String::new();
        block.declare(&mut Vec::new(), &mut text).expect("a string takes all");
        let module = parsed(&format!("{text}@group(0) @binding(0) var<uniform> block: {};", block.name)).expect("valid WGSL");
        let (_, found) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(block.name)).expect("the block");
        let naga::TypeInner::Struct { members, span } = &found.inner else { panic!("{} is no struct", block.name) };
        let found: Vec<_> = members.iter().map(|member| (member.name.as_deref().unwrap_or_default(), member.offset as usize)).collect();
        let wanted: Vec<_> =
            block.members.iter().filter(|member| !member.is_padding()).map(|member| (member.name, member.offset_bytes)).collect();
        assert_eq!(found, wanted, "{}", block.name);
        assert_eq!((*span as usize).next_multiple_of(16), block.bytes, "{}", block.name);
        count += 1;
    }
    assert!(count > 15, "only {count} blocks");
}

/// Constants of all Rust sources in a folder and its subfolders: name, and value if it is distinctive.
fn constants_of(folder: &Path) -> Vec<(String, Option<f64>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(constants_of(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).expect("a source");
            found.extend(text.split("const ").skip(1).filter_map(|rest| {
                let (name, declared) = rest.split_once(':')?;
                Some((name.to_owned(), distinctive(declared.split_once('=')?.1.split(';').next()?)))
            }));
        }
    }
    found
}

/// Value of a literal that is unlikely to coincide with another by chance: one of at least three significant digits that is no power of two.
fn distinctive(literal: &str) -> Option<f64> {
    let literal = literal.trim().replace('_', "");
    let number =
        ["u32", "i32", "f32", "f64", "usize", "u", "i", "f"].iter().find_map(|suffix| literal.strip_suffix(suffix)).unwrap_or(&literal);
    let value: f64 = number.parse().ok()?;
    let digits: String = number.split('e').next()?.chars().filter(char::is_ascii_digit).collect();
    (digits.trim_matches('0').len() >= 3 && value.abs().log2().fract() != 0.0).then_some(value)
}

/// Constants of WGSL files that Rust has, too, by name or by value.
fn written_twice(library: &Library) -> Vec<String> {
    let of_rust: Vec<_> =
        ["src", "../shared/src"].iter().flat_map(|folder| constants_of(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder))).collect();
    let has = |name: &str| of_rust.iter().any(|(other, _)| other == name);
    assert!(has("WIND_FULL_M_PER_S") && has("SORT_TILE"), "constants of both crates");
    let mut found = Vec::new();
    for (path, file) in &library.0 {
        for one in file.declarations.iter().filter(|one| one.text.starts_with("const ")) {
            let value = one.text.trim_end_matches(';').split_once('=').and_then(|(_, value)| distinctive(value));
            let same = of_rust.iter().find(|(name, of_rust)| *name == one.name || value.is_some() && value == *of_rust);
            found.extend(
                same.map(|(name, _)| {
                    format!("{path}.wgsl:{}: {} is `{name}` in Rust: import it from package::constants", one.line, one.name)
                }),
            );
        }
    }
    found
}

#[test]
fn no_constant_is_written_in_wgsl_and_in_rust() {
    let library = Library::new(texts()).expect("sound shaders");
    assert_eq!(written_twice(&library), Vec::<String>::new());
}

#[test]
fn a_copied_constant_is_found_by_name_or_value() {
    let planted = ["SORT_TILE: u32 = 7u", "FALL: f32 = 9.810", "TINY: f32 = 4.19e-6", "HALF: f32 = 0.5", "MANY: u32 = 1024u"];
    let planted = planted.map(|one| format!("const {one};")).concat();
    let library = Library::new([("gpu/planted".to_owned(), planted)]).expect("sound declarations");
    let found = written_twice(&library);
    let names: Vec<_> = found.iter().filter_map(|message| message.split_once(" is `")?.1.split('`').next()).collect();
    assert_eq!(names, ["SORT_TILE", "GRAVITY_M_PER_S2", "DROP_KG"], "{found:?}");
}

/// Folders of shaders, each importing only from itself and those before it, as in `src/render`.
const FOLDERS: [&str; 5] = ["gpu", "inputs", "land_and_sky", "solids", "plants"];

/// Imports against the order of the folders, and the files on circles of imports or importing from one.
fn backward_imports(library: &Library) -> Vec<String> {
    let rank = |file: &str| FOLDERS.iter().position(|folder| file.split('/').next() == Some(folder)).expect("a folder in the list");
    let imports: BTreeSet<_> = library.imports().collect();
    let against = imports.iter().filter(|(from, to)| rank(from) < rank(to)).map(|(from, to)| format!("{from} imports {to}"));
    let mut open: BTreeSet<_> = library.0.keys().map(String::as_str).collect();
    while let Some(done) = open.iter().find(|file| !imports.iter().any(|(from, to)| from == *file && open.contains(to))).copied() {
        open.remove(done);
    }
    against.chain(open.iter().map(|file| format!("{file} is on a circle or imports from one"))).collect()
}

#[test]
fn imports_of_shaders_run_one_way() {
    let library = Library::new(texts()).expect("sound shaders");
    assert_eq!(backward_imports(&library), Vec::<String>::new());
}

#[test]
fn backward_imports_of_shaders_are_found() {
    let backward = |texts: &[(&str, &str)]| {
        backward_imports(
            &Library::new(texts.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned()))).expect("sound declarations"),
        )
    };
    let [low, high] = ["fn low() { high(); }", "fn high() {}"];
    let imported = format!("import package::plants::high::high;\n{low}");
    assert_eq!(backward(&[("inputs/low", &imported), ("plants/high", high)]), ["inputs/low imports plants/high"]);
    let back = "import package::plants::low::low;\nfn high() { low(); }";
    let circle = ["plants/high is on a circle or imports from one", "plants/low is on a circle or imports from one"];
    assert_eq!(backward(&[("plants/low", &imported), ("plants/high", back)]), circle);
}
