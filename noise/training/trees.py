"""Training of decision trees by scikit-learn, and their conversion to plain arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from noise.base.arrays import Array
from noise.base.trees import LEAF, BoostedTrees, QuantileForest

PER_LEAF = 8
"""Values per leaf of a quantile forest, at evenly spaced quantiles."""


def grow_boosted_trees(
    x: NDArray[np.floating[Any]], y: NDArray[np.int64], *, weight: Array, n_rounds: int, seed: int
) -> BoostedTrees:
    """Train boosted trees.

    Parameters
    ----------
    x : ndarray, shape (n, n_features)
        [unit of each feature]; NaN where it is missing.
    y : ndarray of int, shape (n,)
        Classes 0, 1, 2 ..., three or more.
    weight : ndarray, shape (n,)
        Weights of the samples [-].
    n_rounds, seed : int
        Number of trees per class, and random seed.

    Returns
    -------
    BoostedTrees

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> y = np.repeat([0, 1, 2], 100)
    >>> trees = grow_boosted_trees(rng.normal(size=(300, 2)) + 4.0 * y[:, None], y,
    ...                            weight=np.ones(300), n_rounds=10, seed=0)
    >>> trees.probabilities(np.array([[0.0, 0.0], [8.0, np.nan]])).argmax(axis=1).tolist()
    [0, 2]
    """
    # Shallow trees with a third of the features per split generalise from synthetic to other sound.
    rounds, base = boosted_nodes(
        x, y, weight=weight, max_iter=n_rounds, learning_rate=0.1, max_leaf_nodes=16,
        min_samples_leaf=10, max_features=0.3, random_state=seed,
    )  # fmt: skip
    return as_arrays([(k, tree) for trees in rounds for k, tree in enumerate(trees)], base)


def boosted_nodes(
    x: NDArray[np.floating[Any]],
    y: NDArray[np.int64],
    *,
    weight: Array | None = None,
    **settings: Any,
) -> tuple[list[list[NDArray[Any]]], Array]:
    """Train boosted trees and return their nodes, from private attributes of scikit-learn.

    Parameters
    ----------
    x, y, weight
        As in `grow_boosted_trees`, but two classes suffice, and weights are optional.
    **settings
        Parameters of `sklearn.ensemble.HistGradientBoostingClassifier`.

    Returns
    -------
    rounds : list of list of structured ndarray, shape (n_nodes,)
        Nodes of the trees of each round: one tree per class, a single one for two classes.
    base : ndarray, shape (n_trees_a_round,)
        Initial scores [-].
    """
    from sklearn.ensemble import HistGradientBoostingClassifier
    from threadpoolctl import threadpool_limits

    model = HistGradientBoostingClassifier(l2_regularization=1.0, early_stopping=False, **settings)
    with threadpool_limits(1):  # reproducible sums on every machine
        model.fit(x, y, sample_weight=weight)
    rounds = [[tree.nodes for tree in trees] for trees in model._predictors]
    return rounds, np.asarray(model._baseline_prediction).reshape(-1)


def as_arrays(grown: Sequence[tuple[int, NDArray[Any]]], base: Array) -> BoostedTrees:
    """Convert nodes of scikit-learn's trees to arrays.

    Parameters
    ----------
    grown : sequence of (int, structured ndarray, shape (n_nodes,))
        Class and nodes of each tree.
    base : ndarray, shape (n_classes,)
        Initial scores [-].

    Returns
    -------
    BoostedTrees
    """
    nodes = np.concatenate([tree for _, tree in grown])
    counts = np.array([len(tree) for _, tree in grown])
    roots = np.cumsum(counts) - counts
    leaf = nodes["is_leaf"].astype(bool)
    children = np.stack([nodes["left"], nodes["right"]], axis=1) + np.repeat(roots, counts)[:, None]
    return BoostedTrees(
        roots=roots.astype(np.int32),
        classes=np.array([k for k, _ in grown], dtype=np.int16),
        feature=np.where(leaf, LEAF, nodes["feature_idx"]).astype(np.int16),
        threshold=np.where(leaf, 0.0, nodes["num_threshold"]).astype(np.float64),
        children=np.where(leaf[:, None], 0, children).astype(np.int32),
        missing_left=nodes["missing_go_to_left"].astype(bool),
        value=np.where(leaf, nodes["value"], 0.0).astype(np.float64),
        base=base.astype(np.float64),
    )


def grow_quantile_forest(
    x: Array, y: Array, *, n_trees: int, least_leaf: int, share: float, seed: int
) -> QuantileForest:
    """Train a quantile forest.

    Parameters
    ----------
    x : ndarray, shape (n, n_features)
        [unit of each feature]; NaN where it is missing.
    y : ndarray, shape (n,)
        Target values [any unit].
    n_trees, least_leaf : int
        Number of trees, minimum number of samples in a leaf.
    share : float
        Share of the samples for growing a tree; the values of its leaves are from all samples.
    seed : int

    Returns
    -------
    QuantileForest

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> x = rng.uniform(0.0, 1.0, (2000, 1))
    >>> forest = grow_quantile_forest(x, x[:, 0] + 0.1 * rng.normal(size=2000), n_trees=20,
    ...                               least_leaf=20, share=0.5, seed=0)
    >>> low, high = np.quantile(forest.pooled(np.array([[0.5]])), [0.05, 0.95])
    >>> bool(0.25 < low < 0.4 and 0.6 < high < 0.75)
    True
    """
    from sklearn.ensemble import RandomForestRegressor

    model = RandomForestRegressor(
        n_estimators=n_trees,
        min_samples_leaf=least_leaf,
        max_samples=share,
        max_features=0.8,  # many features are missing in a sample
        random_state=seed,
        n_jobs=-1,
    ).fit(x, y)
    arrivals = model.apply(x)
    trees = [_arrays(e.tree_, arrivals[:, k], y) for k, e in enumerate(model.estimators_)]
    counts = np.array([len(feature) for feature, *_ in trees])
    roots = np.cumsum(counts) - counts
    feature, threshold, children, missing_left, values = map(
        np.concatenate, zip(*trees, strict=True)
    )
    children = (children + np.repeat(roots, counts)[:, None]).astype(np.int32)
    return QuantileForest(
        roots.astype(np.int32), feature, threshold, children, missing_left, values=values
    )


def _arrays(tree: Any, arrivals: NDArray[np.int64], y: Array) -> tuple[NDArray[Any], ...]:
    """Return feature, threshold, children and missing_left of a tree, and quantiles of its leaves.

    Nodes are in depth-first order.
    """
    leaf = tree.children_left < 0
    rows = np.cumsum(leaf) - 1
    quantiles = (np.arange(PER_LEAF) + 0.5) / PER_LEAF
    order = np.argsort(arrivals, kind="stable")
    reached, starts = np.unique(arrivals[order], return_index=True)
    values = np.zeros((int(leaf.sum()), PER_LEAF), dtype=np.float16)
    for node, of_node in zip(reached, np.split(y[order], starts[1:]), strict=True):
        values[rows[node]] = np.quantile(of_node, quantiles, method="nearest")
    return (
        np.where(leaf, LEAF, tree.feature).astype(np.int16),
        _at_most(np.where(leaf, 0.0, tree.threshold)),
        np.stack([tree.children_left, tree.children_right], axis=1),
        np.asarray(tree.missing_go_to_left, dtype=bool) & ~leaf,
        values,
    )


def _at_most(threshold: Array) -> NDArray[np.float32]:
    """Round down to single precision, so that single-precision features pass the same branches."""
    rounded = threshold.astype(np.float32)
    return np.where(rounded > threshold, np.nextafter(rounded, np.float32(-np.inf)), rounded)
