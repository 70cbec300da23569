use super::{ALL, FROM_RUST, write_lines};
use crate::render::gpu::constants::WORKGROUP_SIZE;
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
fn each_file_is_valid_with_its_imports() {
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
        let naga::TypeInner::Struct { members, span } = &found.inner else { panic!("{} is not a struct", block.name) };
        let found: Vec<_> = members.iter().map(|member| (member.name.as_deref().unwrap_or_default(), member.offset as usize)).collect();
        let wanted: Vec<_> =
            block.members.iter().filter(|member| !member.is_padding()).map(|member| (member.name, member.offset_bytes)).collect();
        assert_eq!(found, wanted, "{}", block.name);
        assert_eq!((*span as usize).next_multiple_of(16), block.bytes, "{}", block.name);
        count += 1;
    }
    assert!(count > 15, "only {count} blocks");
}

/// Numbers and names of Rust that a shader must not repeat.
#[derive(Default)]
struct FromRust {
    /// Constants: name, and value if it is a literal.
    constants: Vec<(String, Option<f64>)>,
    /// Literals anywhere in the code.
    literals: BTreeSet<u64>,
}

impl FromRust {
    /// Reads all sources in a folder and its subfolders, without their tests.
    fn read(&mut self, folder: &Path) {
        for entry in std::fs::read_dir(folder).expect("a folder of sources") {
            let path = entry.expect("an entry").path();
            if path.is_dir() && !path.ends_with("tests") {
                self.read(&path);
            } else if path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("tests.rs") {
                let text = std::fs::read_to_string(&path).expect("a source");
                let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
                self.constants.extend(code.split("const ").skip(1).filter_map(|rest| {
                    let (name, declared) = rest.split_once(':')?;
                    Some((name.to_owned(), value_of(declared.split_once('=')?.1.split(';').next()?.trim())))
                }));
                self.literals.extend(numbers(code).filter_map(|(_, number)| Some(value_of(number)?.to_bits())));
            }
        }
    }

    /// The Rust value that a number repeats, unless they may coincide by chance. Counted are constants of at least three digits other than powers of
    /// two, the size of a workgroup and one less, literals of at least four digits, and constants of mathematics.
    fn repeated(&self, number: &str) -> Option<String> {
        let value = value_of(number)?;
        let digits = significant_digits(number);
        let is_power = value > 0.0 && value.log2().fract() == 0.0;
        let constant = self.constants.iter().find(|(_, of_rust)| *of_rust == Some(value)).filter(|_| digits >= 3 && !is_power);
        let constant = constant.map(|(name, _)| format!("`{name}` in Rust"));
        let of_workgroup = [(WORKGROUP_SIZE, "`WORKGROUP_SIZE` in Rust"), (WORKGROUP_SIZE - 1, "`WORKGROUP_SIZE - 1` in Rust")];
        let of_workgroup = of_workgroup.iter().find(|(size, _)| !number.contains('.') && value == f64::from(*size));
        let constant = constant.or_else(|| of_workgroup.map(|(_, name)| (*name).to_owned()));
        let of_mathematics = MATHEMATICS.iter().find(|(_, exact)| digits >= 4 && (value - exact).abs() < 1e-5 * exact);
        let of_mathematics = of_mathematics.map(|(name, _)| format!("`{name}` of mathematics"));
        let is_literal = digits >= 4 && (!is_power || digits > 5) && self.literals.contains(&value.to_bits());
        constant.or(of_mathematics).or_else(|| is_literal.then(|| format!("the literal `{number}` in Rust")))
    }
}

/// Constants of mathematics, and simple multiples of them.
const MATHEMATICS: [(&str, f64); 8] = {
    use std::f64::consts::{E, FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, LN_2, PI, SQRT_2, TAU};
    [("π", PI), ("2π", TAU), ("π/2", FRAC_PI_2), ("π/4", FRAC_PI_4), ("1/π", FRAC_1_PI), ("√2", SQRT_2), ("e", E), ("ln 2", LN_2)]
};

/// Value of a literal of Rust or WGSL, without its suffix.
fn value_of(literal: &str) -> Option<f64> {
    let literal = literal.replace('_', "");
    let suffixes = ["u32", "i32", "u64", "i64", "f32", "f64", "usize", "u8", "u", "i", "f"];
    suffixes.iter().find_map(|suffix| literal.strip_suffix(suffix)).unwrap_or(&literal).parse().ok()
}

fn significant_digits(literal: &str) -> usize {
    let number = literal.split(['e', 'u', 'i', 'f']).next().unwrap_or_default();
    let digits: String = number.chars().filter(char::is_ascii_digit).collect();
    let digits = digits.trim_start_matches('0');
    // Zeros after a point do not count, but those of a large whole number do.
    if number.contains('.') { digits.trim_end_matches('0').len() } else { digits.len() }
}

/// Number literals of a text of Rust or WGSL, each with its line counted from 0. Line comments have none.
fn numbers(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    text.lines().enumerate().flat_map(move |(at, line)| {
        let code = line.split("//").next().unwrap_or_default();
        let mut rest = code;
        std::iter::from_fn(move || {
            loop {
                rest = rest.trim_start_matches(|c| !is_part(c));
                if rest.is_empty() {
                    return None;
                }
                let mut length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
                // The sign of an exponent.
                if rest.starts_with(|c: char| c.is_ascii_digit()) && rest[..length].ends_with('e') && rest[length..].starts_with(['+', '-'])
                {
                    length += 1 + rest[length + 1..].find(|c| !is_part(c)).unwrap_or(rest.len() - length - 1);
                }
                let (word, after) = rest.split_at(length);
                rest = after;
                if word.starts_with(|c: char| c.is_ascii_digit()) {
                    return Some((at, word));
                }
            }
        })
    })
}

/// Names and numbers of WGSL files that Rust has, too.
fn written_twice(library: &Library) -> Vec<String> {
    let mut of_rust = FromRust::default();
    ["src", "../shared/src"].iter().for_each(|folder| of_rust.read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)));
    let has = |name: &str| of_rust.constants.iter().any(|(other, _)| other == name);
    assert!(has("FREE_WIND_M") && has("SORT_TILE"), "constants of both crates");
    let mut found = Vec::new();
    for (path, file) in &library.0 {
        for one in &file.declarations {
            if one.text.starts_with("const ") && has(&one.name) {
                found.push(format!("{path}.wgsl:{}: `{}` is also declared in Rust: import it from package::constants", one.line, one.name));
            }
            found.extend(numbers(&one.text).filter_map(|(at, number)| {
                let repeated = of_rust.repeated(number)?;
                Some(format!("{path}.wgsl:{}: {number} is {repeated}: import it from package::constants", one.line + at))
            }));
        }
    }
    found
}

#[test]
fn no_number_is_written_in_wgsl_and_in_rust() {
    let library = Library::new(texts()).expect("sound shaders");
    assert_eq!(written_twice(&library), Vec::<String>::new());
}

#[test]
fn a_copied_number_is_found_by_name_or_value() {
    let planted = [
        "const SORT_TILE: u32 = 7u;",
        "const FALL: f32 = 9.810;",
        "const TINY: f32 = 4.19e-6;",
        "const PLANTED_HALF: f32 = 0.5;",
        "const PLANTED_MANY: u32 = 1024u;",
        "fn weight(x: f32) -> f32 {\n    // 0.7152\n    return x * 9.81;\n}",
        "fn grey(rgb: vec3<f32>) -> f32 {\n    return dot(rgb, vec3<f32>(0.2126, 0.5, 0.25));\n}",
        "fn stir(v: u32) -> u32 { return v * 1664525u + 3u; }",
        "fn unit(v: u32) -> f32 { return f32(v) / 16777216.0; }",
        "fn turned(x: f32) -> f32 { return x * 1.5707963 + 1.25; }",
        "@compute @workgroup_size(64)\nfn pass() {}",
        "fn groups(count: u32) -> u32 { return (count + 63u) / 64u; }",
        "fn metres(x: f32) -> f32 { return x * 64.0; }",
    ];
    let library = Library::new([("gpu/planted".to_owned(), planted.join("\n"))]).expect("sound declarations");
    let found = written_twice(&library);
    let found: Vec<_> = found.iter().filter_map(|message| message.strip_prefix("gpu/planted.wgsl:")?.split_once(": import")).collect();
    let found: Vec<_> = found.iter().map(|(found, _)| *found).collect();
    assert_eq!(
        found,
        [
            "1: `SORT_TILE` is also declared in Rust",
            "2: 9.810 is `GRAVITY_M_PER_S2` in Rust",
            "3: 4.19e-6 is `DROP_KG` in Rust",
            "8: 9.81 is `GRAVITY_M_PER_S2` in Rust",
            "11: 0.2126 is the literal `0.2126` in Rust",
            "13: 1664525u is `HASH_MULTIPLIER` in Rust",
            "14: 16777216.0 is the literal `16777216.0` in Rust",
            "15: 1.5707963 is `π/2` of mathematics",
            "16: 64 is `WORKGROUP_SIZE` in Rust",
            "18: 63u is `WORKGROUP_SIZE - 1` in Rust",
            "18: 64u is `WORKGROUP_SIZE` in Rust",
        ]
    );
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
