//! The ways of drawing that are compared.

use client_wasm::render::{Far, Look, Order};

/// What stands for far plants, in one order of laying plants over each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    /// What stands for far plants.
    pub far: Far,
    /// The order.
    pub order: Order,
}

const fn method(far: Far, order: Order) -> Method {
    Method { far, order }
}

/// Every way for far plants without an order, the default first, and every order with clumps, which have the most that is partly transparent.
pub const METHODS: [Method; 7] = [
    method(Far::Land, Order::Cut),
    method(Far::Clumps, Order::Cut),
    method(Far::Shells, Order::Cut),
    method(Far::Clumps, Order::Coverage),
    method(Far::Clumps, Order::Sorted),
    method(Far::Clumps, Order::Precomputed),
    method(Far::Clumps, Order::Weighted),
];

impl Method {
    /// Such as `clumps, cut`.
    pub fn name(self) -> String {
        format!("{}, {}", self.far.name(), self.order.name())
    }

    /// How a renderer draws it.
    pub fn look(self) -> Look {
        Look { order: self.order, far: self.far, ..Look::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_is_there_once() {
        let has = |is: &dyn Fn(&Method) -> bool| METHODS.iter().any(is);
        assert!(Far::ALL.iter().all(|far| has(&|method| method.far == *far)));
        assert!(Order::ALL.iter().all(|order| has(&|method| method.order == *order)));
        assert_eq!(METHODS[0].look(), Look::default());
        assert!(METHODS.iter().enumerate().all(|(n, method)| !METHODS[..n].contains(method)));
    }
}
