//! Variants of a pipeline, each created when a frame first needs it: software compiles some of them for most of a second.

use crate::render::gpu::shaders::Constant;
use std::sync::OnceLock;

#[cfg(target_arch = "wasm32")]
type Make<const N: usize, P> = Box<dyn Fn([Constant; N]) -> P>;
#[cfg(not(target_arch = "wasm32"))]
type Make<const N: usize, P> = Box<dyn Fn([Constant; N]) -> P + Send + Sync>;

/// Two variants of a pipeline, without and with lamps; override `has_lamps` in WGSL.
pub(crate) type LampVariants<P> = Variants<1, P>;

/// Variants without and with lamps, each without and with interaction spheres or slabs; overrides `has_lamps` and `meets_spheres` in WGSL.
pub(crate) type SphereVariants<P> = Variants<2, P>;

/// Two variants of a pipeline, without and with tests for occlusion; override `tests_occlusion` in WGSL.
pub(crate) type OcclusionVariants<P> = Variants<1, P>;

/// Variants of a pipeline by the values of `N` overrides.
pub(crate) struct Variants<const N: usize, P> {
    /// By the values as bits, the first override in the lowest.
    made: Vec<OnceLock<P>>,
    overrides: [&'static str; N],
    make: Make<N, P>,
}

impl<const N: usize, P> Variants<N, P> {
    /// Variants by these overrides in WGSL that `make` creates.
    pub(crate) fn by(overrides: [&'static str; N], make: impl Fn([Constant; N]) -> P + wgpu::WasmNotSendSync + 'static) -> Self {
        Self { made: (0..1 << N).map(|_| OnceLock::new()).collect(), overrides, make: Box::new(make) }
    }

    /// The variant for these values of the overrides.
    pub(crate) fn with(&self, values: [bool; N]) -> &P {
        self.variant(values.iter().rev().fold(0, |bits, value| bits << 1 | usize::from(*value)))
    }

    /// Creates a variant that no frame has needed yet. Returns false if there is none.
    pub(crate) fn create_next(&self) -> bool {
        let missing = self.made.iter().position(|made| made.get().is_none());
        missing.inspect(|&bits| _ = self.variant(bits)).is_some()
    }

    fn variant(&self, bits: usize) -> &P {
        let constants = std::array::from_fn(|n| (self.overrides[n], bits >> n & 1 == 1));
        self.made[bits].get_or_init(|| (self.make)(constants))
    }
}

impl<P> LampVariants<P> {
    /// Variants that `make` creates.
    pub(crate) fn new(make: impl Fn([Constant; 1]) -> P + wgpu::WasmNotSendSync + 'static) -> Self {
        Self::by(["has_lamps"], make)
    }

    /// Variants without and with tests for occlusion that `make` creates.
    pub(crate) fn tested(make: impl Fn([Constant; 1]) -> P + wgpu::WasmNotSendSync + 'static) -> Self {
        Self::by(["tests_occlusion"], make)
    }

    /// The variant for a frame with or without lamps.
    pub(crate) fn of(&self, has_lamps: bool) -> &P {
        self.with([has_lamps])
    }
}

impl<P> SphereVariants<P> {
    /// Variants that `make` creates.
    pub(crate) fn new(make: impl Fn([Constant; 2]) -> P + wgpu::WasmNotSendSync + 'static) -> Self {
        Self::by(["has_lamps", "meets_spheres"], make)
    }

    /// The variant for a frame with or without spheres and lamps.
    pub(crate) fn of(&self, has_spheres: bool, has_lamps: bool) -> &P {
        self.with([has_lamps, has_spheres])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

    #[test]
    fn each_variant_is_created_once_and_when_it_is_needed() {
        let creations = Arc::new(AtomicU32::new(0));
        let counter = creations.clone();
        let variants = SphereVariants::new(move |[lamps, spheres]| {
            counter.fetch_add(1, Relaxed);
            assert_eq!([lamps.0, spheres.0], ["has_lamps", "meets_spheres"]);
            (spheres.1, lamps.1)
        });
        assert_eq!(creations.load(Relaxed), 0);
        for wanted in [(true, false), (false, true), (true, false)] {
            assert_eq!(*variants.of(wanted.0, wanted.1), wanted);
        }
        assert_eq!(creations.load(Relaxed), 2);
        assert!(variants.create_next() && variants.create_next() && !variants.create_next());
        assert_eq!((creations.load(Relaxed), *variants.of(true, true)), (4, (true, true)));
    }
}
