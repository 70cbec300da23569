//! Resources per blend order. Those of unused orders are kept, since a split picture uses two orders in every frame.

use crate::render::options::render_options::BlendOrder;

pub(crate) struct PerBlendOrder<T> {
    made: Vec<(BlendOrder, T)>,
    /// Index of the one in use.
    at: usize,
}

impl<T> PerBlendOrder<T> {
    /// The resources of `order`, which is in use at first.
    pub(crate) fn new(order: BlendOrder, resources: T) -> Self {
        Self { made: vec![(order, resources)], at: 0 }
    }

    /// Switches to an order; creates its resources on first use.
    pub(crate) fn set(&mut self, order: BlendOrder, make: impl FnOnce() -> T) {
        self.at = self.made.iter().position(|(known, _)| *known == order).unwrap_or(self.made.len());
        if self.at == self.made.len() {
            self.made.push((order, make()));
        }
    }

    /// The order in use.
    pub(crate) fn order(&self) -> BlendOrder {
        self.made[self.at].0
    }

    /// Its resources.
    pub(crate) fn get(&self) -> &T {
        &self.made[self.at].1
    }

    /// Its resources, mutable.
    pub(crate) fn get_mut(&mut self) -> &mut T {
        &mut self.made[self.at].1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resources_of_each_order_are_created_once() {
        let mut creations = 0;
        let mut resources = PerBlendOrder::new(BlendOrder::Cut, BlendOrder::Cut);
        for order in [BlendOrder::Sorted, BlendOrder::Weighted, BlendOrder::Sorted, BlendOrder::Cut, BlendOrder::Weighted] {
            resources.set(order, || {
                creations += 1;
                order
            });
            assert_eq!((resources.order(), *resources.get()), (order, order));
        }
        assert_eq!(creations, 2);
    }
}
