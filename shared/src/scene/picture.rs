//! Start position of the camera, and light.

use crate::light::sun::Sun;
use serde::{Deserialize, Serialize};

/// Start position of the camera.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CameraStart {
    /// Position over the ground as a fraction of the world's extent along X and Z. Default (0.5, 0.62), allowed 0..=1 each.
    pub at: [f32; 2],
    /// Height above the ground (m). Default 2.2, allowed 0.02..=2000.
    pub height_m: f32,
    /// Heading (rad) from north towards east. Default 0.35, allowed −6.3..=6.3.
    pub heading_rad: f32,
    /// Pitch (rad), negative looks down. Default −0.08, allowed −1.5..=1.5.
    pub pitch_rad: f32,
}

impl Default for CameraStart {
    fn default() -> Self {
        Self { at: [0.5, 0.62], height_m: 2.2, heading_rad: 0.35, pitch_rad: -0.08 }
    }
}

/// Sun, sky, haze and mist.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Light {
    /// Heading of the sun (rad), from north towards east; used without an `hour`. Default 0.9, allowed −6.3..=6.3.
    pub sun_heading_rad: f32,
    /// Elevation of the sun above the horizon (rad), used without an `hour`; below 0 it is dusk. Default 0.55, allowed −0.1..=1.57.
    pub sun_elevation_rad: f32,
    /// Hour of local mean solar time at which the scene starts; it determines the position of the sun. Default −1, the sun is at the given heading
    /// and elevation; allowed −1..=24.
    pub hour: f32,
    /// Latitude (degrees), north positive, for the position of the sun at an hour. Default 41, allowed −90..=90.
    pub latitude_deg: f32,
    /// Day of the year for the position of the sun; 1 is 1 January. Default 172, the summer solstice; allowed 1..=366.
    pub day_of_year: f32,
    /// Simulated time in which 24 hours pass (s), the same for all clients; 0: the sun does not move. Needs an `hour`. Default 0, allowed
    /// 0..=1000000.
    pub day_length_secs: f32,
    /// Distance at which haze has absorbed 63 % of a colour (m). Default 900, allowed 10..=100000.
    pub haze_m: f32,
    /// The same for mist on the lowest land (m); 0: no mist. Default 0, allowed 0..=100000.
    pub mist_m: f32,
    /// Height above the lowest land at which the density of mist has fallen to 1/e (m). Default 6, allowed 0.5..=200.
    pub mist_height_m: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            sun_heading_rad: 0.9,
            sun_elevation_rad: 0.55,
            hour: -1.0,
            latitude_deg: 41.0,
            day_of_year: 172.0,
            day_length_secs: 0.0,
            haze_m: 900.0,
            mist_m: 0.0,
            mist_height_m: 6.0,
        }
    }
}

impl Light {
    /// Position of the sun at an hour (0..24), at the scene's latitude and day.
    pub fn sun_at_hour(&self, hour: f32) -> Sun {
        Sun::at_hour(self.latitude_deg, self.day_of_year, hour)
    }

    /// Position of the sun at a simulated time (s).
    pub fn sun_at(&self, time_secs: f64) -> Sun {
        if self.hour < 0.0 {
            return Sun { heading_rad: self.sun_heading_rad, elevation_rad: self.sun_elevation_rad };
        }
        self.sun_at_hour(self.hour_at(time_secs))
    }

    /// Hour of the day (0..24) at a simulated time (s). For a sun at a given heading and elevation: the quarter of an hour, on the scene's latitude and
    /// day, at which the sun is nearest to that position.
    pub fn hour_at(&self, time_secs: f64) -> f32 {
        if self.hour < 0.0 {
            let [x, y, z] = self.sun_at(time_secs).direction();
            let nearness = |hour: &f32| {
                let at = self.sun_at_hour(*hour).direction();
                x * at[0] + y * at[1] + z * at[2]
            };
            let quarters = (0..96_u8).map(|quarter| 0.25 * f32::from(quarter));
            return quarters.max_by(|a, b| nearness(a).total_cmp(&nearness(b))).unwrap_or_default();
        }
        let days = if self.day_length_secs > 0.0 { time_secs / f64::from(self.day_length_secs) } else { 0.0 };
        (f64::from(self.hour) + 24.0 * days.rem_euclid(1.0)).rem_euclid(24.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_ends_after_its_length_and_repeats() {
        let light = Light { hour: 20.0, day_length_secs: 1200.0, ..Light::default() };
        assert_eq!(light.sun_at(0.0), light.sun_at_hour(20.0));
        assert_eq!(light.sun_at(600.0), light.sun_at_hour(8.0));
        assert_eq!(light.sun_at(12_000.0), light.sun_at_hour(20.0));
        assert_eq!(light.hour_at(600.0), 8.0);
        let still = Light { hour: 20.0, ..Light::default() };
        assert_eq!(still.sun_at(5000.0), still.sun_at(0.0));
    }

    #[test]
    fn without_an_hour_the_sun_stands_where_it_is_put() {
        let light = Light { sun_heading_rad: 2.0, sun_elevation_rad: -0.05, ..Light::default() };
        assert_eq!(light.sun_at(1e6), Sun { heading_rad: 2.0, elevation_rad: -0.05 });
    }

    #[test]
    fn the_hour_of_a_sun_at_a_given_position_is_the_nearest_one() {
        for hour in [5.5, 8.25, 12.0, 18.75] {
            let Sun { heading_rad: sun_heading_rad, elevation_rad: sun_elevation_rad } = Light::default().sun_at_hour(hour);
            assert_eq!(Light { sun_heading_rad, sun_elevation_rad, ..Light::default() }.hour_at(1e6), hour);
        }
    }
}
