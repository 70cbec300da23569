//! What `--help` says of examples and files.

pub(super) const EXAMPLES: &str = "\
Examples:
  cargo run --release -p tests --bin chart -- wind
  cargo run --release -p tests --bin chart -- wind --quick --only cavity --out /tmp/charts
  cargo run --release -p tests --bin chart -- wind --tables tests/README.md
  cargo run --release -p tests --bin chart -- bend --only cars
  cargo run --release -p tests --bin chart -- picture --quick --views ant-calm,hill-storm
  cargo run --release -p tests --bin chart -- gallery
  cargo run --release -p tests --bin chart -- plates --only gust
  cargo run --release -p tests --bin chart -- gpu
  cargo run --release -p tests --bin chart -- peers --peer webgpu-grass=../webgpu-grass/dist
  cargo run --release -p tests --bin chart -- start
  cargo run --release -p tests --bin chart -- pictures --only storm
  cargo run --release -p tests --bin chart -- versions --before ../earlier/target/release/prairie
  cargo run --release -p tests --features compressors --bin chart -- stream";

pub(super) const GPU_FILES: &str = "\
Files in DIR:
  gpu.md  frame time at medium, high and ultra, 1920 × 1080 and 3840 × 2160, the time of each kind of pass, and the
          time for a million near blades; with the card's name";

pub(super) const PEERS_FILES: &str = "\
Files in DIR:
  peers.md           frames per second and processor time a frame of each page, and how ours compare
  peers/NAME.jpg     a screenshot of each

A page is built with its own tools first, such as `npm ci && npx vite build`; --peer names the folder with its index.html.";

pub(super) const START_FILES: &str = "\
Files in DIR:
  start.md  times of the first and of the complete picture, and of a frame in the page, at automatic quality, low and medium";

pub(super) const VERSIONS_FILES: &str = "\
Files in DIR:
  VIEW.jpg   the view with the earlier version on the left and with the later one on the right
  README.md  a page of all

An unknown name in --views lists them all. All together take a quarter of an hour.";

pub(super) const SHELLS_FILES: &str = "\
Files in DIR:
  shells-layers.svg, .csv      frames per second against the number of layers, with and without slices between them, and Bakay's
  shells-lamps.svg, .csv, .md  frames per second with no, one and three point lights, and Bakay's statement";

pub(super) const PLATES_FILES: &str = "\
Files in DIR:
  PLATE.jpg  the tiles of a figure
  README.md  a page of all";

pub(super) const STREAM_FILES: &str = "\
Files in DIR:
  stream-DRIVE.svg, .csv  bits per cell and frame against the largest error of θ: drive, wash, cyclone and storm

Built with --features compressors, which needs cmake, libclang and libzstd-dev, the charts have lines of zstd, zfp and SZ3, too.";

pub(super) const FILES: &str = "\
Files in DIR, updated after each problem:
  wind-PROBLEM.svg   error across, time up, both logarithmic; one line per method, further left
                     and down is better; the Pareto front, which nothing beats, is highlighted
  wind.csv, .json    every figure: model, problem, method, cells, dt_secs, norm (l1, l2 = root mean
                     square, linf), error, wall_secs (wall time per simulated second or projection)
  wind-lock-in.svg, .csv  frequency of the waves over grass that sways and over rigid grass against the wind
  wind-honami.svg, .csv   displacement of the grass by place and time
  wind-cylinder.svg, .csv vortices behind a cylinder at Re = 100
  wind-outflow.svg, .csv  a vortex that leaves the box

Printed for each problem and a few errors: the fastest method, interpolated between two runs, and how
much longer the best of another family takes.";

pub(super) const BEND_FILES: &str = "\
Files in DIR:
  bend-PROBLEM.svg        error across, time up, as for the wind; bend.csv and bend.json hold the figures
  bend-cars.svg, .csv     time of a step against the number of moving cars, with a straight line through it
  bend-failures.svg, .csv where each scheme is accurate, inaccurate or blows up: speed of a car against steps per second
  bend-overlap.svg, .csv  error of the loose overlap of Chen & Johan against wave speed, for three damping rates";

pub(super) const PLANTS_FILES: &str = "\
Files in DIR:
  plants-PROBLEM.svg         error across, time up, as for the wind: a blade's integrators in a recorded gust, and the
                             sections of a component under its weight; plants.csv and plants.json hold the figures
  plants-postures.svg, .csv  error of the tip against the size of a posture table, and look-up times
  plants-constraint.svg, .csv force on a plant after a gust, with and without the velocity term of the constraint
  plants-stability.svg, .csv longest stable time step of a blade against its stiffness, measured and in theory";

pub(super) const PICTURE_FILES: &str = "\
Files in DIR:
  picture-VIEW.svg         mean FLIP (x) and frame time (y), both logarithmic; one line per method, whose points
                           are the qualities; picture-all-views.svg has the means over the views
  picture.csv, .json       every figure: view, method, quality, level, ms, FLIP (mean and 99th percentile), SSIM, counts
  picture-plants.svg, .csv time of a frame against the plants of the scene
  picture-height.svg, .csv time of a frame against the height of the view
  picture-vertices.svg, .csv, .md
                           time of the main pass per million vertices, as counted by the GPU
  cache/VIEW-SIZE.png      references, drawn again after this program is rebuilt

--only WORD picks methods (`clumps`, `sorted`) or one of the figures `plants`, `height` and `vertices`.";
