//! No branch depends on uniforms alone: Mesa's software driver (lavapipe of Mesa 22.3) recompiles a shader that has one for every draw or dispatch, with the
//! values of the uniforms inserted, which takes up to a second each time.

use super::{linked, module};
use crate::render::gpu::shaders;
use naga::{AddressSpace, Block, Expression, Function, Handle, LocalVariable, Module, Statement};
use std::collections::HashMap;
use wgpu::naga;

/// Dependency of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Hangs {
    Constant,
    Uniforms,
    Invocation,
}

/// One call of a function: the dependencies of its arguments and local variables.
struct Call<'a> {
    module: &'a Module,
    function: &'a Function,
    arguments: Vec<Hangs>,
    locals: HashMap<Handle<LocalVariable>, Hangs>,
    results: HashMap<Handle<Expression>, Hangs>,
}

impl<'a> Call<'a> {
    fn new(module: &'a Module, function: &'a Function, arguments: Vec<Hangs>) -> Self {
        let mut call = Self { module, function, arguments, locals: HashMap::new(), results: HashMap::new() };
        for (handle, local) in function.local_variables.iter() {
            call.locals.insert(handle, local.init.map_or(Hangs::Constant, |init| call.of(init)));
        }
        call
    }

    fn of(&self, handle: Handle<Expression>) -> Hangs {
        let most = |parts: &[Handle<Expression>]| parts.iter().map(|&part| self.of(part)).max().unwrap_or(Hangs::Constant);
        match &self.function.expressions[handle] {
            Expression::Literal(_) | Expression::Constant(_) | Expression::Override(_) | Expression::ZeroValue(_) => Hangs::Constant,
            Expression::FunctionArgument(index) => self.arguments[*index as usize],
            Expression::LocalVariable(local) => self.locals[local],
            Expression::GlobalVariable(global) => match self.module.global_variables[*global].space {
                AddressSpace::Uniform => Hangs::Uniforms,
                _ => Hangs::Invocation,
            },
            // The value of a dynamically indexed element is not known before the shader runs.
            Expression::Access { base, index } => match self.of(*index) {
                Hangs::Constant => self.of(*base),
                _ => Hangs::Invocation,
            },
            Expression::AccessIndex { base, .. } => self.of(*base),
            Expression::Load { pointer } => self.of(*pointer),
            Expression::Splat { value, .. } | Expression::Swizzle { vector: value, .. } => self.of(*value),
            Expression::Compose { components, .. } => most(components),
            Expression::Unary { expr, .. } | Expression::As { expr, .. } => self.of(*expr),
            Expression::Binary { left, right, .. } => most(&[*left, *right]),
            Expression::Select { condition, accept, reject } => most(&[*condition, *accept, *reject]),
            Expression::Relational { argument, .. } => self.of(*argument),
            Expression::Math { arg, arg1, arg2, arg3, .. } => {
                [Some(*arg), *arg1, *arg2, *arg3].into_iter().flatten().map(|part| self.of(part)).max().unwrap_or(Hangs::Constant)
            }
            Expression::CallResult(_) => self.results.get(&handle).copied().unwrap_or(Hangs::Invocation),
            _ => Hangs::Invocation,
        }
    }

    /// Walks a block under conditions with the dependency `under`; returns that of a value returned from it.
    fn walk(&mut self, block: &Block, under: Hangs, source: &str, found: &mut Vec<String>) -> Hangs {
        let mut returned = Hangs::Constant;
        for statement in block {
            let inner: &[(&Block, Hangs)] = match statement {
                Statement::Block(block) => &[(block, under)],
                Statement::If { condition, accept, reject } => {
                    let on = self.branch(*condition, source, found).max(under);
                    &[(accept, on), (reject, on)]
                }
                Statement::Switch { selector, cases } => {
                    let on = self.branch(*selector, source, found).max(under);
                    for case in cases {
                        returned = returned.max(self.walk(&case.body, on, source, found));
                    }
                    &[]
                }
                Statement::Loop { body, continuing, break_if } => {
                    // The variables that a loop changes are known only after a first walk of its body; only findings after that count.
                    self.walk(body, under, source, &mut Vec::new());
                    if let Some(condition) = break_if {
                        self.branch(*condition, source, found);
                    }
                    &[(body, under), (continuing, under)]
                }
                Statement::Return { value } => {
                    returned = returned.max(under).max(value.map_or(Hangs::Constant, |value| self.of(value)));
                    &[]
                }
                Statement::Store { pointer, value } => {
                    let hangs = self.of(*value).max(under);
                    if let Some(local) = self.stored(*pointer) {
                        let entry = self.locals.entry(local).or_insert(Hangs::Constant);
                        *entry = hangs.max(*entry);
                    }
                    &[]
                }
                Statement::Call { function, arguments, result } => {
                    let called = &self.module.functions[*function];
                    let arguments = arguments.iter().map(|&argument| self.of(argument)).collect();
                    let hangs = Call::new(self.module, called, arguments).walk(&called.body, Hangs::Constant, source, found);
                    if let Some(result) = result {
                        self.results.insert(*result, hangs);
                    }
                    &[]
                }
                _ => &[],
            };
            for (block, under) in inner {
                returned = returned.max(self.walk(block, *under, source, found));
            }
        }
        returned
    }

    /// The local variable that a store changes.
    fn stored(&self, pointer: Handle<Expression>) -> Option<Handle<LocalVariable>> {
        match self.function.expressions[pointer] {
            Expression::LocalVariable(local) => Some(local),
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => self.stored(base),
            _ => None,
        }
    }

    fn branch(&self, condition: Handle<Expression>, source: &str, found: &mut Vec<String>) -> Hangs {
        let hangs = self.of(condition);
        if hangs == Hangs::Uniforms {
            let span = self.function.expressions.get_span(condition);
            let line = source[..span.to_range().map_or(0, |range| range.start)].lines().count();
            found.push(format!(
                "{}: {}",
                self.function.name.as_deref().unwrap_or("?"),
                source.lines().nth(line.max(1) - 1).unwrap_or("").trim()
            ));
        }
        hangs
    }
}

fn branches_of_uniforms(text: &str) -> Vec<String> {
    let module = module(text);
    let mut found = Vec::new();
    for entry in &module.entry_points {
        let arguments = entry.function.arguments.iter().map(|_| Hangs::Invocation).collect();
        let mut of_entry = Vec::new();
        Call::new(&module, &entry.function, arguments).walk(&entry.function.body, Hangs::Constant, text, &mut of_entry);
        found.extend(of_entry.into_iter().map(|branch| format!("{}: {branch}", entry.name)));
    }
    found.sort();
    found.dedup();
    found
}

#[test]
fn no_branch_depends_on_uniforms_alone() {
    let found: Vec<String> = shaders::ALL.iter().flat_map(|shader| branches_of_uniforms(&shader.to_string())).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn branches_of_uniforms_are_found() {
    let found = |body: &str| {
        let frame = "override on: bool = true; fn far(p: vec2<f32>) -> f32 { if p.x < 0.0 { return 1.0; } return p.y; }";
        branches_of_uniforms(&linked(
            "",
            &format!("{frame} @compute @workgroup_size(1) fn f(@builtin(global_invocation_id) id: vec3<u32>) {{ {body} }}"),
        ))
        .len()
    };
    assert_eq!(found("let p = far(vec2<f32>(id.xy));"), 0);
    assert_eq!(found("let p = far(frame.eye_m.xz);"), 1);
    assert_eq!(found("for (var i = 0u; i < u32(frame.eye_m.x); i++) {}"), 1);
    assert_eq!(found("for (var i = 0u; i < id.x; i++) {}"), 0);
    assert_eq!(found("var y = frame.eye_m.y; if f32(id.x) < 2.0 { y = f32(id.x); } if y < 1.0 {}"), 0);
    assert_eq!(found("if frame.eye_m.x > 0.0 && id.x > 1u {}"), 1);
    assert_eq!(found("if id.x > 1u && frame.eye_m.x > 0.0 {}"), 0);
    assert_eq!(found("if on {}"), 0);
    assert_eq!(found("if on && frame.eye_m.x > 0.0 {}"), 1);
    assert_eq!(found("var y = frame.eye_m.y; if on { y = frame.eye_m.z; } if y < 1.0 {}"), 1);
}
