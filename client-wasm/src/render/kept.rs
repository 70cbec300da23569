//! What plants need to be laid over each other in an order, kept for when that is wanted again: two ways side by side take turns within a frame.

use super::look::Order;

pub(super) struct Kept<T> {
    made: Vec<(Order, T)>,
    /// Place of the one in use.
    at: usize,
}

impl<T> Kept<T> {
    /// What `order` needs, which is in use at first.
    pub(super) fn new(order: Order, needed: T) -> Self {
        Self { made: vec![(order, needed)], at: 0 }
    }

    /// Uses another order from now on; makes what it needs if it was not in use before.
    pub(super) fn set(&mut self, order: Order, make: impl FnOnce() -> T) {
        self.at = self.made.iter().position(|(known, _)| *known == order).unwrap_or(self.made.len());
        if self.at == self.made.len() {
            self.made.push((order, make()));
        }
    }

    /// The order in use.
    pub(super) fn order(&self) -> Order {
        self.made[self.at].0
    }

    /// What it needs.
    pub(super) fn get(&self) -> &T {
        &self.made[self.at].1
    }

    /// The same, to be changed.
    pub(super) fn get_mut(&mut self) -> &mut T {
        &mut self.made[self.at].1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_order_is_made_once() {
        let mut makings = 0;
        let mut kept = Kept::new(Order::Cut, Order::Cut);
        for order in [Order::Sorted, Order::Weighted, Order::Sorted, Order::Cut, Order::Weighted] {
            kept.set(order, || {
                makings += 1;
                order
            });
            assert_eq!((kept.order(), *kept.get()), (order, order));
        }
        assert_eq!(makings, 2);
    }
}
