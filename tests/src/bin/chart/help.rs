//! What `--help` says of examples and files.

pub(super) const EXAMPLES: &str = "\
Examples:
  cargo run --release -p tests --bin chart -- tables
  cargo run --release -p tests --bin chart -- picture --quick --views ant-calm,hill-storm
  cargo run --release -p tests --bin chart -- gallery
  cargo run --release -p tests --bin chart -- heights
  cargo run --release -p tests --bin chart -- plates --only gust
  cargo run --release -p tests --bin chart -- gpu
  cargo run --release -p tests --bin chart -- dial
  cargo run --release -p tests --bin chart -- need
  cargo run --release -p tests --bin chart -- peers --peer webgpu-grass=../webgpu-grass/dist
  cargo run --release -p tests --bin chart -- start
  cargo run --release -p tests --bin chart -- pictures --only storm
  cargo run --release -p tests --bin chart -- versions --before ../earlier/target/release/prairie";

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

pub(super) const PLATES_FILES: &str = "\
Files in DIR:
  PLATE.jpg  the tiles of a figure
  README.md  a page of all";

pub(super) const PICTURE_FILES: &str = "\
Files in DIR:
  picture-VIEW.svg         mean FLIP (x) and frame time (y), both logarithmic; one line per method, whose points
                           are the qualities; picture-all-views.svg has the means over the views
  picture.csv, .json       every figure: view, method, quality, level, ms, FLIP (mean and 99th percentile), SSIM, counts
  cache/VIEW-SIZE.png      references, drawn again after this program is rebuilt

--only WORD picks methods, such as `clumps` or `sorted`. `prairie chart picture` draws other figures.";
