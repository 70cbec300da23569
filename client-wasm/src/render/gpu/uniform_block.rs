//! Uniform blocks: Rust structs that declare themselves in WGSL.

use std::fmt;

/// A struct that shaders read as a uniform block.
pub(crate) trait UniformBlock: Sized + 'static {
    const BLOCK: Block;
}

/// Layout of a uniform block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub(crate) name: &'static str,
    pub(crate) bytes: usize,
    pub(crate) members: &'static [Member],
}

/// A member of a block, or padding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Member {
    pub(crate) name: &'static str,
    pub(crate) offset_bytes: usize,
    pub(crate) ty: Type,
}

/// A WGSL type.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Type {
    /// Type, or element type of an array; empty for padding.
    wgsl: &'static str,
    /// Number of array elements; 0 for any other type.
    count: usize,
    align_bytes: usize,
    bytes: usize,
    /// Block that must be declared before the type is used.
    pub(crate) block: Option<&'static Block>,
}

impl Member {
    /// Whether it is padding, which WGSL does not declare.
    pub(crate) const fn is_padding(&self) -> bool {
        self.ty.wgsl.is_empty()
    }
}

impl Block {
    /// Asserts that the layout rules of WGSL give the members the same offsets as in Rust.
    pub(crate) const fn check(&self) {
        let (mut end, mut at) = (0_usize, 0);
        while at < self.members.len() {
            let Member { offset_bytes, ty, .. } = self.members[at];
            if !self.members[at].is_padding() {
                assert!(end.next_multiple_of(ty.align_bytes) == offset_bytes, "WGSL has a member elsewhere: reorder the members or pad");
                end = offset_bytes + ty.bytes;
            }
            at += 1;
        }
        assert!(end.next_multiple_of(16) == self.bytes, "the size of a uniform block is a multiple of 16 bytes");
    }

    /// Writes its declaration, preceded by those of its nested blocks; blocks already in `declared` are skipped.
    pub(crate) fn declare(&self, declared: &mut Vec<&'static str>, out: &mut impl fmt::Write) -> fmt::Result {
        if declared.contains(&self.name) {
            return Ok(());
        }
        declared.push(self.name);
        for block in self.members.iter().filter_map(|member| member.ty.block) {
            block.declare(declared, out)?;
        }
        writeln!(out, "struct {} {{", self.name)?;
        for (at, Member { name, ty, .. }) in self.members.iter().filter(|member| !member.is_padding()).enumerate() {
            // The stride of arrays in uniform buffers is a multiple of 16 bytes.
            let align = if at == 0 { "@align(16) " } else { "" };
            match ty.count {
                0 => writeln!(out, "    {align}{name}: {},", ty.wgsl)?,
                count => writeln!(out, "    {align}{name}: array<{}, {count}>,", ty.wgsl)?,
            }
        }
        writeln!(out, "}}")
    }
}

/// A Rust type that members of a block may have.
pub(crate) trait MemberType {
    const TYPE: Type;
}

macro_rules! member_types {
    ($($rust:ty, $wgsl:literal, $align:literal;)*) => {
        $(impl MemberType for $rust {
            const TYPE: Type = Type { wgsl: $wgsl, count: 0, align_bytes: $align, bytes: size_of::<$rust>(), block: None };
        })*
    };
}

member_types! {
    f32, "f32", 4;
    u32, "u32", 4;
    i32, "i32", 4;
    [f32; 2], "vec2<f32>", 8;
    [u32; 2], "vec2<u32>", 8;
    [i32; 2], "vec2<i32>", 8;
    [f32; 3], "vec3<f32>", 16;
    [f32; 4], "vec4<f32>", 16;
    [f32; 16], "mat4x4<f32>", 16;
}

/// Padding.
impl<const N: usize> MemberType for [u8; N] {
    const TYPE: Type = Type { wgsl: "", count: 0, align_bytes: 1, bytes: N, block: None };
}

impl<B: UniformBlock> MemberType for B {
    const TYPE: Type = Type { wgsl: B::BLOCK.name, count: 0, align_bytes: 16, bytes: B::BLOCK.bytes, block: Some(&B::BLOCK) };
}

impl<B: UniformBlock, const N: usize> MemberType for [B; N] {
    const TYPE: Type = Type { wgsl: B::BLOCK.name, count: N, align_bytes: 16, bytes: N * B::BLOCK.bytes, block: Some(&B::BLOCK) };
}

/// Declares a uniform block. Members of type `[u8; N]` are padding.
macro_rules! uniform_block {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
        pub(crate) struct $name { $($(#[$field_doc])* pub(crate) $field: $type,)* }

        impl $crate::render::gpu::uniform_block::UniformBlock for $name {
            const BLOCK: $crate::render::gpu::uniform_block::Block = $crate::render::gpu::uniform_block::Block {
                name: stringify!($name),
                bytes: size_of::<$name>(),
                members: &[$($crate::render::gpu::uniform_block::Member {
                    name: stringify!($field),
                    offset_bytes: std::mem::offset_of!($name, $field),
                    ty: <$type as $crate::render::gpu::uniform_block::MemberType>::TYPE,
                },)*],
            };
        }

        const _: () = <$name as $crate::render::gpu::uniform_block::UniformBlock>::BLOCK.check();
    };
}

pub(crate) use uniform_block;
