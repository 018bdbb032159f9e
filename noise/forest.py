"""A random forest as plain arrays.

scikit-learn grows the trees; kept are five arrays a forest, in one NPZ file. Such a file runs no
code when it is opened, loads under any version of scikit-learn (or none) and gives the same bytes
of probabilities everywhere, which a pickle does not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Forest", "as_arrays"]

_LEAF = -1


@dataclass(frozen=True, eq=False)
class Forest:
    """Decision trees, their nodes one after the other.

    Parameters
    ----------
    roots : ndarray of int32, shape (n_trees,)
        First node of each tree.
    feature : ndarray of int16, shape (n_nodes,)
        Feature that a node looks at; -1 in a leaf.
    threshold : ndarray of float32, shape (n_nodes,)
        Up to it the way goes left.
    children : ndarray of int32, shape (n_nodes, 2)
        Left and right child.
    missing_left : ndarray of bool, shape (n_nodes,)
        Whether NaN goes left.
    votes : ndarray of float32, shape (n_nodes, n_classes)
        Share of the classes among the training samples of a node.
    """

    roots: NDArray[np.int32]
    feature: NDArray[np.int16]
    threshold: NDArray[np.float32]
    children: NDArray[np.int32]
    missing_left: NDArray[np.bool_]
    votes: NDArray[np.float32]

    def check(self) -> None:
        """Raise ValueError unless every way through the trees ends in a leaf."""
        n = len(self.feature)
        lengths = {len(a) for a in (self.threshold, self.children, self.missing_left, self.votes)}
        if lengths != {n} or self.children.shape[1:] != (2,) or not len(self.roots):
            raise ValueError("its arrays do not fit together")
        inner = np.flatnonzero(self.feature != _LEAF)
        descends = (self.children[inner] > inner[:, None]) & (self.children[inner] < n)
        if not (descends.all() and (self.roots >= 0).all() and (self.roots < n).all()):
            raise ValueError("its trees do not end")

    def probabilities(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mean vote of the trees.

        Parameters
        ----------
        x : ndarray, shape (n, n_features)
            NaN where a feature is missing.

        Returns
        -------
        ndarray, shape (n, n_classes)
        """
        # As scikit-learn does, features are compared in single precision.
        x32 = np.asarray(x, dtype=np.float32)
        rows = np.arange(len(x32))[:, None]
        node = np.broadcast_to(self.roots, (len(x32), self.roots.size)).copy()
        while True:
            feature = self.feature[node]
            inner = feature != _LEAF
            if not inner.any():
                break
            value = x32[rows, np.where(inner, feature, 0)]
            left = np.where(np.isnan(value), self.missing_left[node], value <= self.threshold[node])
            following = np.where(left, self.children[node, 0], self.children[node, 1])
            node = np.where(inner, following, node)
        return np.asarray(self.votes[node].mean(axis=1, dtype=np.float64))


def as_arrays(model: Any) -> Forest:
    """Return a fitted forest of scikit-learn's as arrays.

    Parameters
    ----------
    model : RandomForestClassifier or ExtraTreesClassifier
        Fitted to one output, or to several of yes or no.

    Returns
    -------
    Forest
        Of several outputs the votes are the shares of yes.

    Examples
    --------
    >>> from sklearn.ensemble import RandomForestClassifier
    >>> x, y = np.arange(40.0)[:, None], np.repeat([0, 1], 20)
    >>> forest = as_arrays(RandomForestClassifier(10, random_state=0).fit(x, y))
    >>> forest.probabilities(np.array([[2.0], [38.0]])).round().tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    trees = [estimator.tree_ for estimator in model.estimators_]
    counts = np.array([tree.node_count for tree in trees])
    roots = np.concatenate([[0], np.cumsum(counts)[:-1]])
    children = [
        np.stack([tree.children_left, tree.children_right], axis=1) + root
        for tree, root in zip(trees, roots, strict=True)
    ]
    feature = np.concatenate([tree.feature for tree in trees])
    leaf = feature < 0
    votes = np.concatenate([_votes(tree.value) for tree in trees])
    return Forest(
        roots=roots.astype(np.int32),
        feature=np.where(leaf, _LEAF, feature).astype(np.int16),
        threshold=_at_most(np.concatenate([tree.threshold for tree in trees])),
        children=np.where(leaf[:, None], 0, np.concatenate(children)).astype(np.int32),
        missing_left=np.concatenate([tree.missing_go_to_left for tree in trees]).astype(bool),
        votes=np.where(leaf[:, None], votes, 0.0).astype(np.float32),
    )


def _votes(value: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shares of the classes or, of several yes-or-no outputs, of yes."""
    share = value / value.sum(axis=2, keepdims=True)
    return np.asarray(share[:, 0, :] if value.shape[1] == 1 else share[:, :, 1])


def _at_most(threshold: NDArray[np.float64]) -> NDArray[np.float32]:
    """Round down to single precision, so that no single-precision feature changes sides."""
    rounded = threshold.astype(np.float32)
    return np.where(rounded > threshold, np.nextafter(rounded, np.float32(-np.inf)), rounded)
