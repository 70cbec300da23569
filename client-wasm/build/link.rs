//! Import linker for WGSL: joins the declarations that a pass uses, each unchanged and with its file and line.
//!
//! A file lists its imports from others as in WESL, `import package::inputs::wind::{wind_at, gust_at};`. Names are not changed, so two files of one
//! pass must not declare the same one. `package::constants` and `package::uniforms` are Rust modules, the only source of the declarations imported from them.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;
use std::path::Path;

/// Modules whose declarations come from Rust.
pub(crate) const FROM_RUST: [&str; 2] = ["constants", "uniforms"];

/// Error at a line of a file, counted from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Error {
    pub(crate) file: String,
    pub(crate) line: usize,
    pub(crate) message: String,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.wgsl:{}: {}", self.file, self.line, self.message)
    }
}

/// A declaration at the top of a file: its text without comments, and the identifiers in it.
#[derive(Debug)]
pub(crate) struct Declaration {
    pub(crate) name: String,
    pub(crate) line: usize,
    pub(crate) text: String,
    pub(crate) is_entry: bool,
    words: Vec<Word>,
}

/// An identifier: whether it is called, or names a local variable, parameter or member.
#[derive(Debug)]
struct Word {
    name: String,
    line: usize,
    is_called: bool,
    is_bound: bool,
}

/// An imported name: its module, and the line that imports it.
#[derive(Debug)]
struct Import {
    module: String,
    line: usize,
}

/// A file: its imports by name, and its declarations.
#[derive(Debug, Default)]
pub(crate) struct File {
    imports: BTreeMap<String, Import>,
    pub(crate) declarations: Vec<Declaration>,
}

/// A piece of a linked module.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Piece<'a> {
    /// A declaration of a file.
    Wgsl(&'a str, &'a Declaration),
    /// A declaration of one of the Rust modules, by module and name.
    Rust(&'a str, &'a str),
}

/// All files by their path without extension, such as `inputs/wind`.
#[derive(Debug)]
pub(crate) struct Library(pub(crate) BTreeMap<String, File>);

impl Library {
    /// Reads files given as path and text.
    ///
    /// # Errors
    /// A malformed declaration or import, a name declared twice, or an import of a name that its module does not declare.
    pub(crate) fn new(texts: impl IntoIterator<Item = (String, String)>) -> Result<Self, Error> {
        let files = texts.into_iter().map(|(path, text)| Ok((path.clone(), File::read(&path, &text)?))).collect::<Result<_, Error>>()?;
        let library = Self(files);
        for (path, file) in &library.0 {
            library.check(path, file)?;
        }
        Ok(library)
    }

    /// Paths of the files that are a pass: they declare entry points, and no other file imports those.
    pub(crate) fn passes(&self) -> Vec<&str> {
        let imported: BTreeSet<_> =
            self.0.values().flat_map(|file| file.imports.iter().map(|(name, import)| (import.module.as_str(), name.as_str()))).collect();
        let is_root = |(path, file): &(&String, &File)| {
            file.declarations.iter().any(|one| one.is_entry && !imported.contains(&(path.as_str(), one.name.as_str())))
        };
        self.0.iter().filter(is_root).map(|(path, _)| path.as_str()).collect()
    }

    /// Declarations needed by the entry points of a file and by those that it imports; those of the file itself come last.
    ///
    /// # Errors
    /// Two declarations of the same name.
    pub(crate) fn link<'a>(&'a self, root: &'a str) -> Result<Vec<Piece<'a>>, Error> {
        let file = &self.0[root];
        let own = file.declarations.iter().filter(|one| one.is_entry).map(|one| (root, one.name.as_str()));
        let taken = file.imports.iter().map(|(name, import)| (import.module.as_str(), name.as_str()));
        let entries = taken.filter(|&(module, name)| self.find(module, name).is_some_and(|one| one.is_entry));
        self.join(root, own.chain(entries).collect())
    }

    /// All declarations of a file, and those that they need.
    ///
    /// # Errors
    /// Two declarations of the same name.
    pub(crate) fn unit<'a>(&'a self, root: &'a str) -> Result<Vec<Piece<'a>>, Error> {
        self.join(root, self.0[root].declarations.iter().map(|one| (root, one.name.as_str())).collect())
    }

    fn join<'a>(&'a self, root: &'a str, mut open: VecDeque<(&'a str, &'a str)>) -> Result<Vec<Piece<'a>>, Error> {
        let mut needed = BTreeSet::new();
        while let Some((path, name)) = open.pop_front() {
            if !needed.insert((path, name)) || FROM_RUST.contains(&path) {
                continue;
            }
            let words = self.find(path, name).map_or(&[][..], |one| &one.words);
            open.extend(words.iter().filter_map(|word| self.resolve(path, &word.name)));
        }
        let mut pieces: Vec<_> =
            needed.iter().filter(|(path, _)| FROM_RUST.contains(path)).map(|&(path, name)| Piece::Rust(path, name)).collect();
        let mut names: BTreeMap<&str, &str> =
            pieces.iter().map(|piece| if let Piece::Rust(path, name) = *piece { (name, path) } else { ("", "") }).collect();
        let others = self.0.keys().map(String::as_str).filter(|path| *path != root);
        for path in others.chain([root]) {
            for one in self.0[path].declarations.iter().filter(|one| needed.contains(&(path, one.name.as_str()))) {
                if let Some(other) = names.insert(&one.name, path) {
                    return Err(error(path, one.line, format!("`{}` is also declared in {other}, and {root} needs both", one.name)));
                }
                pieces.push(Piece::Wgsl(path, one));
            }
        }
        Ok(pieces)
    }

    /// Modules and names that files import from Rust.
    pub(crate) fn imports_from_rust(&self) -> impl Iterator<Item = (&str, &str)> {
        let imports = self.0.values().flat_map(|file| &file.imports).map(|(name, import)| (import.module.as_str(), name.as_str()));
        imports.filter(|(module, _)| FROM_RUST.contains(module))
    }

    /// Files, and the files that they import from.
    pub(crate) fn imports(&self) -> impl Iterator<Item = (&str, &str)> {
        let all = self.0.iter().flat_map(|(path, file)| file.imports.values().map(move |import| (path.as_str(), import.module.as_str())));
        all.filter(|(_, module)| !FROM_RUST.contains(module))
    }

    fn find(&self, path: &str, name: &str) -> Option<&Declaration> {
        self.0.get(path)?.declarations.iter().find(|one| one.name == name)
    }

    /// Module and name of the declaration that an identifier in a file refers to, if it is declared there or imported.
    fn resolve<'a>(&'a self, path: &'a str, name: &'a str) -> Option<(&'a str, &'a str)> {
        let file = &self.0[path];
        let own = file.declarations.iter().any(|one| one.name == name).then_some((path, name));
        own.or_else(|| file.imports.get(name).map(|import| (import.module.as_str(), name)))
    }

    fn check(&self, path: &str, file: &File) -> Result<(), Error> {
        let declares = |module: &str, name: &str| FROM_RUST.contains(&module) || self.find(module, name).is_some();
        for (name, import) in &file.imports {
            let is_entry = self.find(&import.module, name).is_some_and(|one| one.is_entry);
            if !declares(&import.module, name) {
                return Err(error(path, import.line, format!("{} declares no `{name}`", import.module)));
            } else if !is_entry && !file.declarations.iter().any(|one| one.words.iter().any(|word| word.name == *name)) {
                return Err(error(path, import.line, format!("`{name}` is imported but not used")));
            }
        }
        let known: BTreeMap<_, _> =
            self.0.iter().flat_map(|(path, file)| file.declarations.iter().map(move |one| (one.name.as_str(), path))).collect();
        for (at, one) in file.declarations.iter().enumerate() {
            if file.imports.contains_key(&one.name) || file.declarations[..at].iter().any(|other| other.name == one.name) {
                return Err(error(path, one.line, format!("`{}` is declared twice", one.name)));
            }
            let bound: BTreeSet<_> = one.words.iter().filter(|word| word.is_bound).map(|word| word.name.as_str()).collect();
            let is_local = |word: &Word| !word.is_called && bound.contains(word.name.as_str());
            for word in one.words.iter().filter(|word| self.resolve(path, &word.name).is_none() && !is_local(word)) {
                if let Some(other) = known.get(word.name.as_str()) {
                    return Err(error(path, word.line, format!("`{}` is declared in {other} but not imported", word.name)));
                }
            }
        }
        Ok(())
    }
}

/// All WGSL files of a folder and its subfolders, as path without extension and text.
pub(crate) fn files(folder: &Path) -> std::io::Result<Vec<(String, String)>> {
    let (mut found, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(&next)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if let Some(name) = path.strip_prefix(folder).ok().and_then(|name| name.to_str()?.strip_suffix(".wgsl")) {
                found.push((name.replace('\\', "/"), std::fs::read_to_string(&path)?));
            }
        }
    }
    Ok(found)
}

fn error(file: &str, line: usize, message: String) -> Error {
    Error { file: file.to_owned(), line, message }
}

impl File {
    fn read(path: &str, text: &str) -> Result<Self, Error> {
        let mut file = Self::default();
        let bare = without_comments(text);
        let tokens = tokens(&bare);
        let mut rest = tokens.as_slice();
        while let Some(first) = rest.first() {
            let (mut depth, mut end) = (0_i32, None);
            for (at, token) in rest.iter().enumerate() {
                depth += i32::from(["{", "(", "["].contains(&token.text)) - i32::from(["}", ")", "]"].contains(&token.text));
                if depth < 0 || (depth == 0 && (token.text == ";" || token.text == "}" && first.text != "import")) {
                    end = Some(at + 1).filter(|_| depth == 0);
                    break;
                }
            }
            let end =
                end.ok_or_else(|| error(path, first.line, "this declaration has no end, or brackets that do not match".to_owned()))?;
            let (tokens, after) = rest.split_at(end);
            rest = after;
            match first.text {
                ";" => {}
                "import" => file
                    .import(tokens)
                    .ok_or_else(|| error(path, first.line, "expected `import package::folder::file::{names};`".to_owned()))?,
                _ => {
                    let text = &bare[first.at..tokens[end - 1].at + 1];
                    let declared = Declaration::read(text, tokens);
                    file.declarations
                        .push(declared.ok_or_else(|| error(path, first.line, "expected a declaration with a name".to_owned()))?);
                }
            }
        }
        Ok(file)
    }

    /// Adds the names of an import: `import package :: folder :: file :: { a , b } ;` or `... :: a ;`.
    fn import(&mut self, tokens: &[Token<'_>]) -> Option<()> {
        let words: Vec<_> = tokens[1..].iter().filter(|token| token.is_word()).collect();
        let brace = tokens.iter().position(|token| token.text == "{").unwrap_or(tokens.len() - 2);
        let (path, names) = words.split_at(words.len() - tokens[brace..].iter().filter(|token| token.is_word()).count());
        let (package, path) = path.split_first()?;
        let module = path.iter().map(|word| word.text).collect::<Vec<_>>().join("/");
        for name in names {
            self.imports.insert(name.text.to_owned(), Import { module: module.clone(), line: name.line });
        }
        (package.text == "package" && !path.is_empty() && !names.is_empty()).then_some(())
    }
}

impl Declaration {
    fn read(text: &str, tokens: &[Token<'_>]) -> Option<Self> {
        let keyword = tokens.iter().position(|token| ["fn", "struct", "const", "override", "var", "alias"].contains(&token.text))?;
        let mut at = keyword + 1;
        if tokens.get(at)?.text == "<" {
            at += tokens[at..].iter().position(|token| token.text == ">")? + 1;
        }
        let name = tokens.get(at).filter(|token| token.is_word())?;
        let is_attribute = |at: usize| at > 0 && tokens[at - 1].text == "@";
        let is_entry = tokens[..keyword]
            .iter()
            .enumerate()
            .any(|(at, token)| is_attribute(at) && ["vertex", "fragment", "compute"].contains(&token.text));
        let words = tokens
            .iter()
            .enumerate()
            .filter(|(at, token)| token.is_word() && !is_attribute(*at) && (*at == 0 || tokens[at - 1].text != "."));
        let words = words.map(|(at, token)| {
            let next = tokens.get(at + 1).map_or("", |next| next.text);
            let is_bound = next == ":" || (at > 0 && ["let", "var", "const"].contains(&tokens[at - 1].text));
            Word { name: token.text.to_owned(), line: token.line, is_called: next == "(", is_bound }
        });
        Some(Self { name: name.text.to_owned(), line: tokens[0].line, text: text.to_owned(), is_entry, words: words.collect() })
    }
}

/// A word, a number, or one other character, with its place in the text and its line.
#[derive(Debug, Clone, Copy)]
struct Token<'a> {
    text: &'a str,
    at: usize,
    line: usize,
}

impl Token<'_> {
    fn is_word(&self) -> bool {
        self.text.starts_with(|c: char| c.is_alphabetic() || c == '_')
    }
}

fn tokens(text: &str) -> Vec<Token<'_>> {
    let (mut found, mut line, mut at) = (Vec::new(), 1, 0);
    while let Some(first) = text[at..].chars().next() {
        let is_part = |c: char| c.is_alphanumeric() || c == '_' || (c == '.' && first.is_ascii_digit());
        let length = if is_part(first) { text[at..].find(|c: char| !is_part(c)).unwrap_or(text.len() - at) } else { first.len_utf8() };
        if !first.is_whitespace() {
            found.push(Token { text: &text[at..at + length], at, line });
        }
        line += usize::from(first == '\n');
        at += length;
    }
    found
}

/// The text without its line comments; line numbers do not change.
fn without_comments(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or_default().trim_end().to_owned() + "\n").collect()
}
