//! Circles of a directed graph: its strongly connected components of more than one node.

/// Components of more than one node among `count` nodes; each sorted.
pub fn circles(count: usize, edges: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let mut forward = vec![Vec::new(); count];
    let mut backward = vec![Vec::new(); count];
    for &(from, to) in edges {
        forward[from].push(to);
        backward[to].push(from);
    }
    let mut is_done = vec![false; count];
    let mut found = Vec::new();
    for node in 0..count {
        if is_done[node] {
            continue;
        }
        let [after, before] = [reachable(node, &forward), reachable(node, &backward)];
        let component: Vec<usize> = (0..count).filter(|n| after[*n] && before[*n]).collect();
        component.iter().for_each(|n| is_done[*n] = true);
        if component.len() > 1 {
            found.push(component);
        }
    }
    found
}

/// One flag per node: whether it can be reached from `start`; `start` itself can.
fn reachable(start: usize, edges: &[Vec<usize>]) -> Vec<bool> {
    let mut is_reached = vec![false; edges.len()];
    let mut open = vec![start];
    while let Some(node) = open.pop() {
        if !std::mem::replace(&mut is_reached[node], true) {
            open.extend(&edges[node]);
        }
    }
    is_reached
}

#[test]
fn circles_are_found() {
    let edges = [(0, 1), (1, 2), (2, 1), (3, 0), (4, 5), (5, 6), (6, 4)];
    assert_eq!(circles(7, &edges), [vec![1, 2], vec![4, 5, 6]]);
    assert!(circles(3, &[(0, 1), (0, 2), (1, 2)]).is_empty());
}
