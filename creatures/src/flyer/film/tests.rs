//! Areas and force points (T-5), and which triangles cross (T-4 is tested on whole creatures).

use super::*;

fn film(corners: [[f64; 3]; 3]) -> Film {
    Film { corners: corners.map(DVec3::from_array) }
}

/// In the plane z = 0, with legs of 10 m.
fn floor() -> Film {
    film([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]])
}

fn shifted(film: &Film, by: [f64; 3]) -> Film {
    film.seen(DMat3::IDENTITY, DVec3::from_array(by))
}

/// T-5, F-21
#[test]
fn the_air_acts_on_the_centroids_of_four_equal_pieces() {
    let film = film([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [0.0, 0.0, 30.0]]);
    assert!((film.area() - 300.0).abs() < 1e-12);
    let expected = [[3.3333, 0.0, 5.0], [13.3333, 0.0, 5.0], [3.3333, 0.0, 20.0], [6.6667, 0.0, 10.0]];
    for (found, expected) in film.centroids().into_iter().zip(expected) {
        assert!((found - DVec3::from_array(expected)).length() < 1e-4, "{found}");
    }
    let mean = film.centroids().into_iter().sum::<DVec3>() / 4.0;
    assert!((mean - film.centroids()[3]).length() < 1e-12);
}

///
#[test]
fn corners_on_a_line_make_no_film() {
    let [a, b, c] = [DVec3::ZERO, DVec3::X, 3.0 * DVec3::X];
    assert_eq!(Film::between([a, b, c]), None);
    assert_eq!(Film::between([a, b, c + 1.9e-6 * DVec3::Y]), None);
    assert!(Film::between([a, b, c + 2.1e-6 * DVec3::Y]).is_some());
}

#[test]
fn films_that_pass_through_each_other_cross() {
    let wall = film([[2.0, 2.0, -1.0], [3.0, 2.0, 5.0], [2.0, 4.0, 5.0]]);
    assert!(floor().crosses(&wall) && wall.crosses(&floor()));
    let beyond = shifted(&wall, [8.0, 8.0, 0.0]);
    assert!(!floor().crosses(&beyond) && !beyond.crosses(&floor()));
    let above = shifted(&wall, [0.0, 0.0, 1.01]);
    assert!(!floor().crosses(&above) && !above.crosses(&floor()));
}

#[test]
fn films_of_one_plane_cross_if_they_overlap() {
    let corner = film([[4.0, 4.0, 0.0], [9.0, 4.0, 0.0], [4.0, 9.0, 0.0]]);
    assert!(floor().crosses(&corner) && corner.crosses(&floor()));
    let beside = shifted(&corner, [1.1, 1.1, 0.0]);
    assert!(!floor().crosses(&beside) && !beside.crosses(&floor()));
    let within = film([[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]]);
    assert!(floor().crosses(&within) && within.crosses(&floor()));
    assert!(!floor().crosses(&shifted(&within, [0.0, 0.0, 1e-5])), "parallel planes do not meet");
}

/// F-23: a shared bone or corner is no crossing.
#[test]
fn films_that_share_a_bone_or_a_corner_do_not_cross() {
    let [a, b, c] = floor().corners;
    let hinged = |third: DVec3| Film { corners: [a, b, third] };
    for third in [DVec3::new(3.0, -4.0, 0.0), DVec3::new(3.0, 0.0, 7.0), DVec3::new(3.0, 1.0, 5.0)] {
        assert!(!floor().crosses(&hinged(third)), "{third}");
    }
    assert!(floor().crosses(&hinged(c)), "folded flat onto its neighbour");
    let corner = film([[0.0, 0.0, 0.0], [-3.0, -4.0, 1.0], [-3.0, 4.0, 2.0]]);
    assert!(!floor().crosses(&corner));
}

/// Mirror images that reach through the mirror's plane meet on it, edge upon edge.
#[test]
fn mirror_images_that_pass_the_mirror_cross_whatever_the_rounding() {
    let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    for k in 0..200 {
        let tilt = 0.037 * f64::from(k);
        let through = film([[3.0, 1.0 + tilt, 0.1], [4.0, -tilt, 7.3], [-1.0 / (1.0 + tilt), 5.1, 2.2]]);
        let image = through.seen(mirror, DVec3::ZERO);
        assert!(through.crosses(&image) && image.crosses(&through), "tilt {tilt}");
    }
}
