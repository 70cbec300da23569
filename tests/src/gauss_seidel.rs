//! The pressure solve of 000 as its listing has it (§2.3.6): collocated velocities, 20 sweeps of Gauss–Seidel. A baseline to measure against.

/// A cube of n³ cells with a layer of wall cells around it.
pub struct GaussSeidelProjection {
    n: usize,
    potential: Vec<f32>,
    divergence: Vec<f32>,
}

impl GaussSeidelProjection {
    /// Sweeps in 000's `linear_solver`.
    pub const SWEEPS: usize = 20;

    /// Room for a cube of `n`³ cells.
    pub fn new(n: usize) -> Self {
        let len = (n + 2).pow(3);
        Self { n, potential: vec![0.0; len], divergence: vec![0.0; len] }
    }

    /// Index of cell (i, j, k), 1 to n in the cube, 0 and n + 1 in the walls.
    pub fn index(&self, i: usize, j: usize, k: usize) -> usize {
        let side = self.n + 2;
        i + side * (j + side * k)
    }

    /// Divergence of collocated velocities by central differences, spacing 1; its root mean square.
    pub fn divergence_rms(&mut self, [u, v, w]: &[Vec<f32>; 3]) -> f64 {
        let side = self.n + 2;
        let mut squares = 0.0;
        for k in 1..=self.n {
            for j in 1..=self.n {
                for i in 1..=self.n {
                    let at = self.index(i, j, k);
                    let net = u[at + 1] - u[at - 1] + v[at + side] - v[at - side] + w[at + side * side] - w[at - side * side];
                    self.divergence[at] = -0.5 * net;
                    squares += f64::from(self.divergence[at]).powi(2);
                }
            }
        }
        (squares / self.n.pow(3) as f64).sqrt()
    }

    /// 000's `project`.
    pub fn project(&mut self, velocity: &mut [Vec<f32>; 3]) {
        let side = self.n + 2;
        self.divergence_rms(velocity);
        self.potential.fill(0.0);
        for _ in 0..Self::SWEEPS {
            for k in 1..=self.n {
                for j in 1..=self.n {
                    for i in 1..=self.n {
                        let at = self.index(i, j, k);
                        let p = &self.potential;
                        let around = p[at - 1] + p[at + 1] + p[at - side] + p[at + side] + p[at - side * side] + p[at + side * side];
                        self.potential[at] = (self.divergence[at] + around) / 6.0;
                    }
                }
            }
            self.copy_to_walls();
        }
        for k in 1..=self.n {
            for j in 1..=self.n {
                for i in 1..=self.n {
                    let at = self.index(i, j, k);
                    for (axis, step) in [1, side, side * side].into_iter().enumerate() {
                        velocity[axis][at] -= 0.5 * (self.potential[at + step] - self.potential[at - step]);
                    }
                }
            }
        }
    }

    /// 000's `set_bound` for a scalar: wall cells take their neighbour's value.
    fn copy_to_walls(&mut self) {
        let n = self.n;
        for b in 1..=n {
            for a in 1..=n {
                for (wall, inside) in [(0, 1), (n + 1, n)] {
                    let pairs = [
                        (self.index(wall, a, b), self.index(inside, a, b)),
                        (self.index(a, wall, b), self.index(a, inside, b)),
                        (self.index(a, b, wall), self.index(a, b, inside)),
                    ];
                    pairs.into_iter().for_each(|(wall, inside)| self.potential[wall] = self.potential[inside]);
                }
            }
        }
    }
}
