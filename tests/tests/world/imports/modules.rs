//! The modules of a crate, and the file that a path leads to.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context as _, Result};

use super::circles::Graph;
use super::parse::{Declared, Path};

/// Maximum number of re-exports followed along a path.
const MAX_REEXPORTS: usize = 16;

struct Module {
    file: usize,
    parent: usize,
    children: BTreeMap<String, usize>,
    declared: Declared,
}

/// Target of a path.
#[derive(Clone, Copy)]
enum End {
    Module(usize),
    /// An item, declared in this module.
    Item(usize),
}

/// All modules of a crate; the first is its root.
pub(super) struct Modules {
    files: Vec<String>,
    modules: Vec<Module>,
}

impl Modules {
    /// Reads the root of a crate, such as `lib.rs`, and every module below it. `read` gives the text of a file by its path below `src`, if it exists.
    pub(super) fn of_crate(root: &str, read: &mut dyn FnMut(&str) -> Option<String>) -> Result<Self> {
        let text = read(root).with_context(|| format!("{root} is missing"))?;
        let mut modules = Self { files: vec![root.to_owned()], modules: Vec::new() };
        let root = Declared::parse(&text).with_context(|| root.to_owned())?;
        modules.add(root, 0, 0, "", read)?;
        Ok(modules)
    }

    /// Adds a module and its children; `dir` is the folder of the children, with a slash at its end.
    fn add(
        &mut self,
        mut declared: Declared,
        file: usize,
        parent: usize,
        dir: &str,
        read: &mut dyn FnMut(&str) -> Option<String>,
    ) -> Result<usize> {
        let children = std::mem::take(&mut declared.children);
        let id = self.modules.len();
        self.modules.push(Module { file, parent, children: BTreeMap::new(), declared });
        for (name, inline) in children {
            let inner_dir = format!("{dir}{name}/");
            let child = match inline {
                Some(inner) => self.add(inner, file, id, &inner_dir, read)?,
                None => {
                    let paths = [format!("{dir}{name}.rs"), format!("{inner_dir}mod.rs")];
                    let found = paths.into_iter().find_map(|path| read(&path).map(|text| (path, text)));
                    let (path, text) = found.with_context(|| format!("no file of module {name} in {dir}"))?;
                    let inner = Declared::parse(&text).with_context(|| path.clone())?;
                    self.files.push(path);
                    self.add(inner, self.files.len() - 1, id, &inner_dir, read)?
                }
            };
            self.modules[id].children.insert(name, child);
        }
        Ok(id)
    }

    /// Every file, with the files that declare the names it imports or mentions.
    pub(super) fn graph(&self) -> Graph {
        let mut arrows = vec![BTreeSet::new(); self.files.len()];
        for (id, module) in self.modules.iter().enumerate() {
            let passed_on = |name: &String| module.declared.imports.iter().any(|import| import.is_reexport && import.name == *name);
            let imported =
                module.declared.imports.iter().filter(|import| !import.is_reexport && import.name != "*").map(|import| &import.path);
            let mentioned = module.declared.paths.iter().filter(|path| path.len() > 1 || path.iter().any(passed_on) || self.has_glob(id));
            for path in imported.chain(mentioned) {
                if let Some(End::Item(of)) = self.resolve(id, path, MAX_REEXPORTS) {
                    arrows[module.file].insert(self.modules[of].file);
                }
            }
        }
        for (file, to) in arrows.iter_mut().enumerate() {
            to.remove(&file);
        }
        Graph { files: self.files.clone(), arrows }
    }

    fn has_glob(&self, id: usize) -> bool {
        self.modules[id].declared.imports.iter().any(|import| import.name == "*")
    }

    fn resolve(&self, from: usize, path: &Path, depth: usize) -> Option<End> {
        let mut end = End::Module(from);
        for (n, segment) in path.iter().enumerate() {
            let End::Module(module) = end else { break };
            end = match segment.as_str() {
                "crate" if n == 0 => End::Module(0),
                "self" if n == 0 => end,
                "super" => End::Module(self.modules[module].parent),
                name => self.find(module, name, depth)?,
            };
        }
        Some(end)
    }

    /// Resolves a name in a module to a child, an item, or an import of either.
    fn find(&self, module: usize, name: &str, depth: usize) -> Option<End> {
        let Module { children, declared, .. } = &self.modules[module];
        if let Some(child) = children.get(name) {
            return Some(End::Module(*child));
        }
        if declared.items.iter().any(|item| item == name) {
            return Some(End::Item(module));
        }
        let depth = depth.checked_sub(1)?;
        // `use x::y` of a name that is itself called `x` in this module would never end.
        let import = declared.imports.iter().find(|import| import.name == name && import.path.first().is_none_or(|first| first != name));
        if let Some(import) = import {
            return self.resolve(module, &import.path, depth);
        }
        let globs = declared.imports.iter().filter(|import| import.name == "*");
        globs.filter_map(|glob| self.resolve(module, &glob.path, depth)).find_map(|end| match end {
            End::Module(of) if of != module => self.find(of, name, depth),
            _ => None,
        })
    }
}
