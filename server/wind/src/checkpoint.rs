//! Complete copies of the air, from which it continues bit for bit.

use super::state::StateError;
use super::{Air, Field, Real, Solver, StableFluids, Velocity};
use serde::{Deserialize, Serialize};

/// A complete copy of [`Air`]. Unlike [`State`](super::State) it includes ghosts and the first guess of an iterative pressure solver, so that air with the same
/// settings continues bit for bit with every scheme. Solid cells are settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AirState<R> {
    /// Time since the start (s).
    pub time_secs: f64,
    /// Positions of the sponge layers (m).
    pub sponge_m: Option<[f64; 2]>,
    /// The fields in memory order: for [`Solver`] velocity, pressure gradient, dust, canopy fraction and, if the canopy moves, its
    /// displacement and velocity; for [`StableFluids`] velocity, the earlier velocity,
    /// pressure and dust.
    pub fields: Vec<Vec<R>>,
    /// Potential of the last pressure solve; empty where no solve begins with it.
    pub potential: Vec<f64>,
}

/// Copies lists into others, whose memory is used again.
fn copy_into<'a, R: Real>(copies: &mut Vec<Vec<R>>, lists: impl Iterator<Item = &'a Vec<R>>) {
    let mut count = 0;
    for list in lists {
        if count == copies.len() {
            copies.push(Vec::new());
        }
        copies[count].clone_from(list);
        count += 1;
    }
    copies.truncate(count);
}

/// Sets lists from others of the same lengths; changes nothing if a length differs.
fn set<R: Copy>(own: Vec<&mut Vec<R>>, given: &[Vec<R>]) -> Result<(), StateError> {
    StateError::check("fields", given.len(), own.len())?;
    for (own, given) in own.iter().zip(given) {
        StateError::check("a field", given.len(), own.len())?;
    }
    own.into_iter().zip(given).for_each(|(own, given)| own.copy_from_slice(given));
    Ok(())
}

fn lists<'a, R>(velocities: [&'a mut Velocity<R>; 2], others: impl Iterator<Item = &'a mut Field<R>>) -> Vec<&'a mut Vec<R>> {
    velocities.into_iter().flat_map(|velocity| &mut velocity.0).chain(others).map(|field| &mut field.data).collect()
}

impl<R: Real> Solver<R> {
    fn save_completely_into(&self, state: &mut AirState<R>) {
        let velocities = [&self.velocity, &self.pressure_gradient].into_iter().flat_map(|velocity| &velocity.0);
        let stems = self.stems.iter().flat_map(|stems| &stems.values);
        copy_into(&mut state.fields, velocities.chain(&self.dust).map(|field| &field.data).chain([&self.canopy_fraction]).chain(stems));
        state.potential.clear();
        state.potential.extend_from_slice(self.projection.guess().unwrap_or_default());
        (state.time_secs, state.sponge_m) = (self.time_secs, self.sponge_m);
    }

    fn restore_completely(&mut self, state: &AirState<R>) -> Result<(), StateError> {
        let guess = self.projection.guess_mut();
        StateError::check("the potential", state.potential.len(), guess.as_ref().map_or(0, |guess| guess.len()))?;
        let mut own = lists([&mut self.velocity, &mut self.pressure_gradient], self.dust.iter_mut());
        own.push(&mut self.canopy_fraction);
        own.extend(self.stems.iter_mut().flat_map(|stems| &mut stems.values));
        set(own, &state.fields)?;
        if let Some(guess) = guess {
            guess.copy_from_slice(&state.potential);
        }
        (self.time_secs, self.sponge_m) = (state.time_secs, state.sponge_m);
        self.boundaries.update_inflow(self.time_secs);
        self.measure();
        Ok(())
    }
}

impl<R: Real> StableFluids<R> {
    fn save_completely_into(&self, state: &mut AirState<R>) {
        let velocities = [&self.velocity, &self.before].into_iter().flat_map(|velocity| &velocity.0);
        copy_into(&mut state.fields, velocities.chain([&self.p]).chain(&self.dust).map(|field| &field.data));
        state.potential.clear();
        (state.time_secs, state.sponge_m) = (self.time_secs, self.sponge_m);
    }

    fn restore_completely(&mut self, state: &AirState<R>) -> Result<(), StateError> {
        let others = std::iter::once(&mut self.p).chain(&mut self.dust);
        set(lists([&mut self.velocity, &mut self.before], others), &state.fields)?;
        (self.time_secs, self.sponge_m) = (state.time_secs, state.sponge_m);
        Ok(())
    }
}

impl<R: Real> Air<R> {
    /// A complete copy of the state.
    pub fn state(&self) -> AirState<R> {
        let mut state = AirState::default();
        self.save_into(&mut state);
        state
    }

    /// Copies the complete state into `state`, whose memory is used again.
    pub fn save_into(&self, state: &mut AirState<R>) {
        match self {
            Self::Staggered(air) => air.save_completely_into(state),
            Self::StableFluids(air) => air.save_completely_into(state),
        }
    }

    /// Restores a copy of air with the same settings and solid cells. Later steps are bit-identical to those of the original.
    ///
    /// # Errors
    /// A field of the wrong size; nothing changes then.
    pub fn restore(&mut self, state: &AirState<R>) -> Result<(), StateError> {
        match self {
            Self::Staggered(air) => air.restore_completely(state),
            Self::StableFluids(air) => air.restore_completely(state),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pressure::{Effort, IterativeMethod};
    use super::super::{Advection, Boundary, Config, Dust, Method, Pressure, TimeScheme};
    use super::*;

    #[test]
    fn air_continues_bit_for_bit_with_every_scheme() {
        let schemes = [
            (Advection::MacCormack, TimeScheme::Split),
            (Advection::MacCormack, TimeScheme::Reflection),
            (Config::default().advection, Config::default().time),
        ];
        let iterative = Pressure::Iterative(IterativeMethod::Multigrid, Effort { tolerance: 1e-3, sweeps: 3 });
        for (method, pressure) in [(Method::Staggered, Pressure::Direct), (Method::Staggered, iterative), (Method::StableFluids, iterative)]
        {
            for (advection, time) in schemes.into_iter().filter(|(advection, time)| time.allows(*advection)) {
                let boundary = [[Boundary::Wrap; 2], [Boundary::FreeSlip; 2], [Boundary::Wrap; 2]];
                let config =
                    Config { cells: [8, 4, 8], boundary, advection, time, pressure, dust: Some(Dust::default()), ..Config::default() };
                let mut air = Air::<f32>::new(method, &config).unwrap();
                let step = |air: &mut Air<f32>| air.step(0.05, &[]).unwrap();
                (0..5).for_each(|_| _ = step(&mut air));
                let mut copy = Air::<f32>::new(method, &config).unwrap();
                copy.restore(&air.state()).unwrap();
                for _ in 0..5 {
                    assert_eq!(step(&mut air), step(&mut copy), "{method:?} {pressure:?} {time:?}");
                }
                assert_eq!(air.state(), copy.state(), "{method:?} {pressure:?} {time:?}");
                let other = Air::<f32>::new(method, &Config { cells: [8; 3], ..config }).unwrap().state();
                assert!(copy.restore(&other).is_err());
                assert_eq!(air.state(), copy.state(), "unchanged");
            }
        }
    }
}
