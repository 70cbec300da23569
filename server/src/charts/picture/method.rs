//! The compared render options.

use prairie_client::render::{BlendOrder, FarPlants, RenderOptions};

/// A representation of distant plants with a transparency order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    /// Representation of distant plants.
    pub far: FarPlants,
    /// Transparency order.
    pub order: BlendOrder,
}

const fn method(far: FarPlants, order: BlendOrder) -> Method {
    Method { far, order }
}

/// Every representation of distant plants with the default order, the default first; and every order with clumps, which have the most transparency.
pub const METHODS: [Method; 7] = [
    method(FarPlants::Land, BlendOrder::Cut),
    method(FarPlants::Clumps, BlendOrder::Cut),
    method(FarPlants::Shells, BlendOrder::Cut),
    method(FarPlants::Clumps, BlendOrder::Coverage),
    method(FarPlants::Clumps, BlendOrder::Sorted),
    method(FarPlants::Clumps, BlendOrder::Precomputed),
    method(FarPlants::Clumps, BlendOrder::Weighted),
];

impl Method {
    /// Name, such as `clumps, cut`.
    pub fn name(self) -> String {
        format!("{}, {}", self.far.name(), self.order.name())
    }

    /// The render options.
    pub fn look(self) -> RenderOptions {
        RenderOptions { blend_order: self.order, far_plants: self.far, ..RenderOptions::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_is_measured_and_no_method_twice() {
        let has = |is: &dyn Fn(&Method) -> bool| METHODS.iter().any(is);
        assert!(FarPlants::ALL.iter().all(|far| has(&|method| method.far == *far)));
        assert!(BlendOrder::ALL.iter().all(|order| has(&|method| method.order == *order)));
        assert_eq!(METHODS[0].look(), RenderOptions::default());
        assert!(METHODS.iter().enumerate().all(|(n, method)| !METHODS[..n].contains(method)));
    }
}
