import unittest

import pleat
import take


class Stop(Exception):
    pass


class ErrorTest(unittest.TestCase):
    def test_errors_have_a_code_and_words(self):
        with self.assertRaises(pleat.Error) as raised:
            pleat.Character.from_bytes(b"")
        self.assertIsInstance(raised.exception, RuntimeError)
        self.assertIn(raised.exception.code, ("INVALID_ARGUMENT", "DATA_LOSS"))
        self.assertGreater(len(str(raised.exception)), 20)

    def test_progress_is_told_to_the_end(self):
        told = []
        pleat.train(take.performer(), learner="ridge", progress=lambda stage, share: told.append((stage, share)))
        shares = [share for _, share in told]
        self.assertGreater(len(shares), 3)
        self.assertTrue(all(0 <= share <= 1 for share in shares))
        self.assertAlmostEqual(shares[-1], 1)
        self.assertTrue(all(stage for stage, _ in told))

    def test_what_progress_raises_ends_the_work_and_is_raised(self):
        calls = []

        def stop(stage, share):
            calls.append(stage)
            raise Stop("enough")

        with self.assertRaisesRegex(Stop, "enough"):
            pleat.train(take.performer(), progress=stop)
        self.assertEqual(len(calls), 1)


if __name__ == "__main__":
    unittest.main()
