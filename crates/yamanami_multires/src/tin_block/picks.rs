//! The triangle of least cost, found again after each change: a tree of matches between slots.
//!
//! Based on: Knuth, "The Art of Computer Programming 3: Sorting and Searching", 1973, section 5.4.1 (tournaments). Many costs
//! change between two picks and few of them matter: a change climbs only as far as it alters who wins.

/// The cost of each slot, and who wins each match.
#[derive(Debug, Default)]
pub(super) struct Picks {
    cost: Vec<f64>,
    /// Winner of match `n` between those of `2n` and `2n + 1`; slots enter from the middle on.
    winner: Vec<u32>,
}

impl Picks {
    /// Slots with these costs; infinite where one is not to be picked.
    pub(super) fn new(cost: Vec<f64>) -> Self {
        let leaves = cost.len().next_power_of_two();
        let mut picks = Self { cost, winner: vec![0; 2 * leaves] };
        for slot in 0..leaves {
            picks.winner[leaves + slot] = slot as u32;
        }
        for n in (1..leaves).rev() {
            picks.winner[n] = picks.better(n);
        }
        picks
    }

    /// The slot of least cost, the first among equals; `None` where there is none to pick.
    pub(super) fn least(&self) -> Option<u32> {
        self.winner.get(1).copied().filter(|&slot| self.cost(slot).is_finite())
    }

    /// A slot's cost.
    pub(super) fn cost(&self, slot: u32) -> f64 {
        self.cost.get(slot as usize).copied().unwrap_or(f64::INFINITY)
    }

    /// Gives a slot another cost.
    pub(super) fn set(&mut self, slot: u32, cost: f64) {
        self.cost[slot as usize] = cost;
        let mut n = (self.winner.len() / 2 + slot as usize) / 2;
        while n > 0 {
            let better = self.better(n);
            if self.winner[n] == better && better != slot {
                // others see nothing of the change
                return;
            }
            self.winner[n] = better;
            n /= 2;
        }
    }

    fn better(&self, n: usize) -> u32 {
        let [left, right] = [self.winner[2 * n], self.winner[2 * n + 1]];
        if self.cost(right) < self.cost(left) { right } else { left }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_least_is_the_least(
            start in prop::collection::vec(0u8..9, 1..20), changes in prop::collection::vec((any::<prop::sample::Index>(), 0u8..10), 0..40),
        ) {
            let mut costs: Vec<f64> = start.into_iter().map(f64::from).collect();
            let mut picks = Picks::new(costs.clone());
            for (at, cost) in changes {
                let (slot, cost) = (at.index(costs.len()), if cost == 9 { f64::INFINITY } else { f64::from(cost) });
                costs[slot] = cost;
                picks.set(slot as u32, cost);
                let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
                let first = costs.iter().position(|&c| c == least && c.is_finite());
                prop_assert_eq!(picks.least(), first.map(|slot| slot as u32));
            }
        }
    }
}
