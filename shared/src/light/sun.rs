//! Position of the sun by latitude, day and hour.

use std::f64::consts::TAU;

/// Position of the sun in the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Heading (rad), from north towards east.
    pub heading_rad: f32,
    /// Elevation of its centre above the horizon (rad); negative when it is down.
    pub elevation_rad: f32,
}

impl Sun {
    /// The sun at a latitude (degrees, north positive) and an hour (0..24, local mean solar time) of a day (1 is 1 January): declination and equation
    /// of time by Spencer 1971, then the spherical triangle of pole, zenith and sun. Within 0.1° of almanacs; without refraction, which raises a
    /// setting sun by 0.5°.
    pub fn at_hour(latitude_deg: f32, day_of_year: f32, hour: f32) -> Self {
        let hour = f64::from(hour);
        let year = TAU / 365.0 * (f64::from(day_of_year) - 1.0 + (hour - 12.0) / 24.0);
        let [(s1, c1), (s2, c2), (s3, c3)] = [1.0, 2.0, 3.0].map(|n| (n * year).sin_cos());
        let declination = 0.006918 - 0.399912 * c1 + 0.070257 * s1 - 0.006758 * c2 + 0.000907 * s2 - 0.002697 * c3 + 0.00148 * s3;
        let equation_rad = 0.000075 + 0.001868 * c1 - 0.032077 * s1 - 0.014615 * c2 - 0.040849 * s2;
        let hour_angle = (hour - 12.0) / 24.0 * TAU + equation_rad;
        let (sin_latitude, cos_latitude) = f64::from(latitude_deg).to_radians().sin_cos();
        let (sin_declination, cos_declination) = declination.sin_cos();
        let east = -cos_declination * hour_angle.sin();
        let north = cos_latitude * sin_declination - sin_latitude * cos_declination * hour_angle.cos();
        let up = sin_latitude * sin_declination + cos_latitude * cos_declination * hour_angle.cos();
        Self { heading_rad: east.atan2(north) as f32, elevation_rad: up.clamp(-1.0, 1.0).asin() as f32 }
    }

    /// Unit vector towards the sun.
    pub fn direction(self) -> [f32; 3] {
        let level = self.elevation_rad.cos();
        [self.heading_rad.sin() * level, self.elevation_rad.sin(), -self.heading_rad.cos() * level]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_stands(sun: Sun, heading_deg: f32, elevation_deg: f32) {
        let heading = sun.heading_rad.to_degrees().rem_euclid(360.0);
        let apart = (heading - heading_deg + 180.0).rem_euclid(360.0) - 180.0;
        assert!(apart.abs() < 0.5, "heading {heading}° instead of {heading_deg}°");
        let elevation = sun.elevation_rad.to_degrees();
        assert!((elevation - elevation_deg).abs() < 0.5, "elevation {elevation}° instead of {elevation_deg}°");
    }

    /// Example of Reda & Andreas: Golden, Colorado, 17 October 2003, 12:30:30 at UTC − 7 h, 105.1786° west, so 12.4964 h of local mean time.
    #[test]
    fn stands_where_the_nrel_algorithm_has_it() {
        assert_stands(Sun::at_hour(39.742476, 290.0, 12.4964), 194.340, 90.0 - 50.112);
    }

    /// At true noon the elevation is 90° minus latitude plus declination: ±23.44° at the solstices, 0° at the equinoxes.
    #[test]
    fn culminates_by_the_declination_of_the_season() {
        for (latitude_deg, day, hour, heading_deg, elevation_deg) in [
            (51.48, 172.0, 12.03, 180.0, 61.96),
            (51.48, 355.0, 11.97, 180.0, 15.08),
            (0.0, 79.3, 6.12, 90.0, 0.0),
            (-33.87, 355.0, 11.97, 0.0, 79.57),
            (69.65, 172.0, 0.03, 0.0, 3.09),
        ] {
            assert_stands(Sun::at_hour(latitude_deg, day, hour), heading_deg, elevation_deg);
        }
    }

    #[test]
    fn points_to_its_heading() {
        let [x, y, z] = Sun { heading_rad: std::f32::consts::FRAC_PI_2, elevation_rad: 0.3 }.direction();
        assert!((x - 0.3_f32.cos()).abs() < 1e-6 && (y - 0.3_f32.sin()).abs() < 1e-6 && z.abs() < 1e-6);
    }
}
