//! An alarm clock for nodes: who must be looked at again when the clock has come so far.
//!
//! The clock counts change (of the eye's place, of its direction, of the threshold), not time. Alarms further off than
//! the wheel is long ring at its end and are set again.

use yamanami_core::NodeId;

const SLOTS: u32 = 4096;

#[derive(Debug, Clone)]
pub(crate) struct Wheel {
    slots: Vec<Vec<NodeId>>,
    clock: f64,
    /// First tick that has not been rung in full.
    next: u32,
}

impl Wheel {
    pub(crate) fn new() -> Self {
        Self { slots: vec![Vec::new(); SLOTS as usize], clock: 0.0, next: 0 }
    }

    /// Sets an alarm `after` units from now and gives its tick.
    #[inline]
    pub(crate) fn set(&mut self, node: NodeId, after: f64) -> u32 {
        let ahead = after.clamp(0.0, f64::from(SLOTS - 2));
        let tick = ((self.clock + ahead) as u32).clamp(self.next, self.next + SLOTS - 1);
        self.slots[(tick % SLOTS) as usize].push(node);
        tick
    }

    /// Moves the clock and rings every alarm whose tick has begun, handing out (node, tick).
    pub(crate) fn advance(&mut self, by: f64, mut ring: impl FnMut(NodeId, u32)) {
        self.clock += by;
        let now = self.clock as u32;
        // after a jump longer than the wheel every slot has rung once
        let from = self.next.max(now.saturating_sub(SLOTS - 1));
        let from = if now >= self.next.saturating_add(SLOTS) { self.next } else { from };
        let until = now.min(from.saturating_add(SLOTS - 1));
        for tick in from..=until {
            let slot = (tick % SLOTS) as usize;
            let mut nodes = std::mem::take(&mut self.slots[slot]);
            for &node in &nodes {
                ring(node, tick);
            }
            nodes.clear();
            // keep the room: frames ring about as many as the last one
            if self.slots[slot].is_empty() {
                self.slots[slot] = nodes;
            }
        }
        self.next = now;
    }

    /// Forgets all alarms.
    pub(crate) fn clear(&mut self) {
        self.slots.iter_mut().for_each(Vec::clear);
        self.clock = 0.0;
        self.next = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alarms_ring_no_later_than_set() {
        let mut wheel = Wheel::new();
        let mut due = vec![];
        for node in 0..500u32 {
            let after = f64::from(node) * 7.3;
            wheel.set(node, after);
            due.push(after.min(f64::from(SLOTS - 2)));
        }
        let mut clock = 0.0;
        let mut rung = vec![false; 500];
        for step in [0.0, 0.4, 0.7, 100.0, 3.3, 900.0, 5000.0] {
            clock += step;
            wheel.advance(step, |node, _| rung[node as usize] = true);
            for node in 0..500 {
                assert!(rung[node] || due[node] > clock, "node {node} due {} at {clock}", due[node]);
            }
        }
        assert!(rung.iter().all(|&r| r));
    }

    #[test]
    fn a_slot_set_now_rings_on_the_next_advance() {
        let mut wheel = Wheel::new();
        wheel.advance(10.5, |_, _| ());
        let tick = wheel.set(3, 0.0);
        let mut rung = vec![];
        wheel.advance(0.0, |node, at| rung.push((node, at)));
        assert_eq!(rung, [(3, tick)]);
    }
}
