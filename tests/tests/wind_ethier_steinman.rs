use tests::orders;
#[test]
fn a() { for c in [0.1] {let t = std::time::Instant::now();
 for r in orders::beltrami(c, &[8, 12, 16, 24,32]) { println!("{c} {r}"); }; println!("{:?}", t.elapsed()); }}
