use super::*;
use nalgebra::DMatrix;

/// A-5, the table of springs as published: number, ends, tissue and length at rest.
const SPRINGS_PUBLISHED: &str = include_str!("springs.txt");

fn letter(tissue: Tissue) -> &'static str {
    match tissue {
        Tissue::Cross => "x",
        Tissue::Muscle => "m",
        Tissue::Structural => "s",
    }
}

///
#[test]
fn the_rule_of_construction_gives_the_table_of_springs() {
    let body = Body::published(1.0);
    let rows = Design::published().springs.into_iter().zip(&body.lattice.springs).enumerate();
    let found: Vec<String> = rows
        .map(|(index, (link, spring))| {
            let ([i, j], tissue) = (link.ends, letter(link.tissue));
            format!("{index} {i}-{j} {tissue} {:.4}", spring.rest_length)
        })
        .collect();
    assert_eq!(found, SPRINGS_PUBLISHED.lines().collect::<Vec<_>>());
}

/// T-1
#[test]
fn the_published_body_has_its_counts_lengths_and_degrees() {
    let design = Design::published();
    let body = Body::published(1.0);
    let of = |tissue: Tissue| {
        design.springs.iter().zip(&body.lattice.springs).filter(move |(link, _)| link.tissue == tissue)
    };
    let total = |tissue| of(tissue).map(|(_, spring)| spring.rest_length).sum::<f64>();
    assert_eq!(
        [Tissue::Cross, Tissue::Muscle, Tissue::Structural].map(|tissue| of(tissue).count()),
        [46, 12, 33]
    );
    for (tissue, expected) in
        [(Tissue::Muscle, 46.895353), (Tissue::Cross, 222.135741), (Tissue::Structural, 107.070890)]
    {
        assert!((total(tissue) - expected).abs() < 1e-6, "{tissue:?}");
    }
    let degree = |node: usize| design.springs.iter().filter(|link| link.ends.contains(&node)).count();
    let degrees: Vec<usize> = (0..NODES).map(degree).collect();
    let expected: Vec<usize> = [vec![4], vec![7; 4], vec![9; 12], vec![8; 4], vec![5; 2]].concat();
    assert_eq!(degrees, expected);
    let mass: f64 = body.lattice.masses.iter().sum();
    assert!((mass - 107.03).abs() < 1e-12);
}

/// T-1
#[test]
fn the_published_body_is_rigid_and_nothing_more() {
    let body = Body::published(1.0);
    let mut rigidity = DMatrix::zeros(SPRINGS, 3 * NODES);
    for (row, spring) in body.lattice.springs.iter().enumerate() {
        let [i, j] = spring.ends;
        let direction = (body.rest[j] - body.rest[i]) / spring.rest_length;
        for (axis, share) in direction.to_array().into_iter().enumerate() {
            rigidity[(row, 3 * i + axis)] = -share;
            rigidity[(row, 3 * j + axis)] = share;
        }
    }
    let mut values: Vec<f64> = rigidity.singular_values().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    assert!(values[5] < 1e-12 && (values[6] - 0.277834).abs() < 1e-6, "{:?}", &values[..7]);
}

/// T-1
#[test]
fn the_skin_is_closed() {
    let body = Body::published(1.0);
    let (mut area, mut volume, mut sum) = (0.0, 0.0, DVec3::ZERO);
    for face in &body.lattice.faces {
        let [a, b, c] = face.corners.map(|corner| body.rest[corner]);
        let across = (b - a).cross(c - a) * (0.5 * face.weight);
        area += across.length();
        volume += across.dot(a) / 3.0;
        sum += across;
    }
    assert_eq!(body.lattice.faces.len(), 78);
    assert!((area - 238.107082).abs() < 1e-6 && (volume - 179.906667).abs() < 1e-6, "{area} {volume}");
    assert!(sum.length() < 1e-13, "{sum}");
}

///
#[test]
fn muscles_are_numbered_by_segment_and_corner() {
    let body = Body::published(1.0);
    let ends = body.muscles.map(|muscle| body.lattice.springs[muscle].ends);
    let expected: Vec<[usize; 2]> = (1..13).map(|node| [node, node + 4]).collect();
    assert_eq!(ends.to_vec(), expected);
}

///
#[test]
fn a_size_scales_lengths_once_and_all_else_twice() {
    let (one, other) = (Body::published(1.0), Body::published(1.7));
    assert_eq!(other.length(), 34.0);
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b.abs(), "{a} {b}");
    for (a, b) in one.lattice.springs.iter().zip(&other.lattice.springs) {
        close(b.rest_length, 1.7 * a.rest_length);
        close(b.stiffness, 2.89 * a.stiffness);
    }
    close(other.lattice.masses[3], 2.89 * one.lattice.masses[3]);
    close(other.lattice.damping, 2.89 * one.lattice.damping);
}

fn refused(change: impl FnOnce(&mut Design)) -> String {
    let mut design = Design::published();
    change(&mut design);
    Body::new(&design, 1.0).unwrap_err().to_string()
}

/// AF-1
#[test]
fn a_body_that_is_not_whole_is_refused_with_its_first_fault() {
    let messages = [
        refused(|design| design.nodes.truncate(22)),
        refused(|design| design.springs.truncate(90)),
        refused(|design| design.springs[7].tissue = Tissue::Cross),
        refused(|design| design.nodes[20].mass = 0.0),
        refused(|design| design.nodes[4].position[1] = f64::NAN),
        refused(|design| design.springs[90].stiffness = -1.0),
        refused(|design| design.springs[3].ends = [4, 4]),
        refused(|design| design.springs[3].ends = [0, 3]),
        refused(|design| design.springs[3].ends = [0, 23]),
        refused(|design| design.springs.swap(3, 4)),
        refused(|design| design.nodes[2].position[0] = 1.2),
        refused(|design| design.nodes[21].mass = 0.2),
        refused(|design| design.springs[12].stiffness = 39.0),
    ];
    let expected = [
        "22 nodes where a fish has 23",
        "90 springs where a fish has 91",
        "11 muscles where a fish has 12",
        "`nodes[20].mass`: 0 is not above 0",
        "`nodes[4].position`: [-1.1, NaN, -1.6] is nowhere",
        "`springs[90].stiffness`: -1 is not above 0",
        "`springs[3]`: joins node 4 to itself",
        "`springs[3]`: joins nodes 0 and 3 once more",
        "`springs[3]`: ends at node 23, the last is 22",
        "`springs[4]`: joins nodes 0 and 4 out of the order of numbers",
        "`nodes[1]` has no left-right mirror image",
        "`nodes[21]` has no top-bottom mirror image",
        "`springs[8]` has no left-right mirror image",
    ];
    assert_eq!(messages.map(|message| message.to_string()), expected.map(str::to_owned));
}

/// AF-1: the count of springs holds, but all of the nose's hold it within one plane's reach, or not at all.
#[test]
fn a_loose_or_unconnected_body_is_refused() {
    // The nose in the plane of ring 1 can be pushed out of it.
    let loose = refused(|design| design.nodes[0].position = [0.0, 4.0, 0.0]);
    assert!(loose.starts_with("springs hold 62 of 63"), "{loose}");
    // Cut the nose off, and spend its four springs between rings 1 and 3.
    let cut = refused(|design| {
        let stiffness = 30.0;
        let stays = [[1, 9], [2, 10], [3, 11], [4, 12]];
        let stays = stays.map(|ends| Link { ends, tissue: Tissue::Structural, stiffness });
        design.springs.drain(0..4);
        design.springs.extend(stays);
        design.springs.sort_by_key(|link| link.ends);
    });
    assert_eq!(cut, "`nodes[1]` hangs on nothing");
}
