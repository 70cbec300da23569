//! The names that one source file declares, imports and mentions.

use anyhow::{Context as _, Result};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemMod, ItemUse, Macro, UseTree, Visibility};

/// A path as its segments, such as `crate`, `wind`, `Solver`.
pub(super) type Path = Vec<String>;

/// A `use` of one name.
pub(super) struct Import {
    /// Its name in the module; `*` for all names of a module.
    pub(super) name: String,
    pub(super) path: Path,
    /// Whether it is a re-export (`pub use`), which alone is no dependency.
    pub(super) is_reexport: bool,
}

/// A module as far as imports matter, without tests.
#[derive(Default)]
pub(super) struct Declared {
    pub(super) items: Vec<String>,
    pub(super) imports: Vec<Import>,
    /// Paths in signatures, bodies and macro calls.
    pub(super) paths: Vec<Path>,
    /// Child modules: in this file, or `None` for one in a file of its own.
    pub(super) children: Vec<(String, Option<Declared>)>,
}

impl Declared {
    /// Reads the source of a file.
    pub(super) fn parse(source: &str) -> Result<Self> {
        let file = syn::parse_file(source).context("not Rust")?;
        let mut declared = Self::default();
        declared.visit_file(&file);
        Ok(declared)
    }

    fn import(&mut self, tree: &UseTree, prefix: &mut Path, is_reexport: bool) {
        let mut add = |name: String, last: Option<String>| {
            let path = prefix.iter().cloned().chain(last.filter(|last| last != "self")).collect();
            self.imports.push(Import { name, path, is_reexport });
        };
        match tree {
            UseTree::Path(path) => {
                prefix.push(path.ident.to_string());
                self.import(&path.tree, prefix, is_reexport);
                prefix.pop();
            }
            UseTree::Name(name) if name.ident == "self" => add(prefix.last().cloned().unwrap_or_default(), None),
            UseTree::Name(name) => add(name.ident.to_string(), Some(name.ident.to_string())),
            UseTree::Rename(rename) => add(rename.rename.to_string(), Some(rename.ident.to_string())),
            UseTree::Glob(_) => add("*".to_owned(), None),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.import(tree, prefix, is_reexport)),
        }
    }
}

impl<'a> Visit<'a> for Declared {
    fn visit_item(&mut self, item: &'a Item) {
        let (attributes, name): (&[Attribute], _) = match item {
            Item::Const(item) => (&item.attrs, Some(&item.ident)),
            Item::Enum(item) => (&item.attrs, Some(&item.ident)),
            Item::Fn(item) => (&item.attrs, Some(&item.sig.ident)),
            Item::Impl(item) => (&item.attrs, None),
            Item::Macro(item) => (&item.attrs, item.ident.as_ref()),
            Item::Mod(item) => (&item.attrs, None),
            Item::Static(item) => (&item.attrs, Some(&item.ident)),
            Item::Struct(item) => (&item.attrs, Some(&item.ident)),
            Item::Trait(item) => (&item.attrs, Some(&item.ident)),
            Item::Type(item) => (&item.attrs, Some(&item.ident)),
            Item::Use(item) => (&item.attrs, None),
            _ => (&[], None),
        };
        if attributes.iter().any(is_test) {
            return;
        }
        self.items.extend(name.map(ToString::to_string));
        visit::visit_item(self, item);
    }

    fn visit_item_mod(&mut self, module: &'a ItemMod) {
        let inline = module.content.as_ref().map(|(_, items)| {
            let mut inner = Self::default();
            items.iter().for_each(|item| inner.visit_item(item));
            inner
        });
        self.children.push((module.ident.to_string(), inline));
    }

    fn visit_item_use(&mut self, item: &'a ItemUse) {
        self.import(&item.tree, &mut Path::new(), !matches!(item.vis, Visibility::Inherited));
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        self.paths.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    /// The arguments of a macro are tokens: segments joined by `::` are a path.
    fn visit_macro(&mut self, call: &'a Macro) {
        let tokens = call.tokens.to_string().replace(" :: ", "::");
        let words = tokens.split(|c: char| !c.is_alphanumeric() && c != '_' && c != ':');
        self.paths.extend(words.filter(|word| word.contains("::")).map(|word| word.split("::").map(String::from).collect()));
        visit::visit_macro(self, call);
    }
}

/// Whether an attribute makes an item test-only.
fn is_test(attribute: &Attribute) -> bool {
    let syn::Meta::List(list) = &attribute.meta else { return attribute.path().is_ident("test") };
    list.path.is_ident("cfg") && (list.tokens.to_string() == "test" || list.tokens.to_string().starts_with("all (test"))
}
